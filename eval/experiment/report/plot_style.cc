// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/report/plot_style.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "base/text/escape.h"

namespace sextant {

std::string LineStyle(std::size_t i) {
  // Okabe and Ito's colours, which colour-blind people distinguish, from dark to light and back.
  constexpr std::array<const char*, 7> kColours = {"#000000", "#D55E00", "#0072B2", "#009E73",
                                                   "#CC79A7", "#56B4E9", "#E69F00"};
  constexpr std::array<int, 8> kMarkers = {6, 4, 8, 10, 12, 2, 1, 3};
  constexpr std::array<const char*, 5> kDashes = {"1", "'-'", "'.'", "'-.'", "'- -  '"};
  constexpr double kMaxWidth = 3.0;
  constexpr double kMaxMarker = 1.4;
  const double thinner = static_cast<double>(std::min<std::size_t>(i, 8));
  return fmt::format("lc rgb '{}' dt {} pt {} lw {:.2f} ps {:.2f}", kColours[i % kColours.size()],
                     kDashes[i % kDashes.size()], kMarkers[i % kMarkers.size()],
                     kMaxWidth - 0.15 * thinner, kMaxMarker - 0.1 * thinner);
}

std::string PlotFrame(const PlotSpec& plot, std::size_t longest_name) {
  // Beside the plot, long names would take half of its width.
  constexpr std::size_t kMaxBeside = 24;
  const char* place = longest_name > kMaxBeside ? "bmargin center" : "outside right";
  return fmt::format(
      "set key {} noenhanced samplen 5\nset grid\nset autoscale xfix\nset title {} noenhanced\n"
      "set xlabel {} noenhanced\nset ylabel {} noenhanced\n{}{}",
      place, GnuplotText(plot.title), GnuplotText(plot.x_label), GnuplotText(plot.y_label),
      plot.log_x ? "set logscale x\n" : "", plot.log_y ? "set logscale y\n" : "");
}

}  // namespace sextant
