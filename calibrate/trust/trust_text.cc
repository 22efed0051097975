// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/trust_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/units.h"

namespace sextant {
namespace {

// "4.1 mm and 0.08 deg": the root of the sum over the axes.
std::string SigmaText(const Vector6d& sigma) {
  return fmt::format("{:.2g} mm and {:.2g} deg", sigma.tail<3>().norm() * 1e3,
                     sigma.head<3>().norm() / kRadPerDeg);
}

std::string ErrorText(const std::optional<double>& metres, const std::optional<double>& pixels) {
  if (metres) return fmt::format("{:.1f} mm", *metres * 1e3);
  return pixels ? fmt::format("{:.2f} px", *pixels) : "unknown";
}

std::string CrossValidationText(const TrustFigures& figures) {
  if (!figures.held_out_rmse_m && !figures.held_out_rmse_px) return "";
  return fmt::format("The RMS error of held-out corners is {}, of fitted ones {}. ",
                     ErrorText(figures.held_out_rmse_m, figures.held_out_rmse_px),
                     ErrorText(figures.fit_rmse_m, figures.fit_rmse_px));
}

std::string SigmasText(const TrustFigures& figures) {
  std::string text;
  if (figures.solver_sigma) {
    text += "The noise model alone allows " + SigmaText(*figures.solver_sigma);
  }
  if (figures.bootstrap_sigma) {
    text +=
        (text.empty() ? "The bootstrap over views gives " : ", the bootstrap over views gives ") +
        SigmaText(*figures.bootstrap_sigma);
  }
  if (figures.jackknife_sigma) {
    text += (text.empty() ? "The jackknife gives " : ", the jackknife gives ") +
            SigmaText(*figures.jackknife_sigma);
  }
  return text.empty() ? text : text + " (1 sigma). ";
}

std::string ComparisonText(const TrustFigures& figures, int views) {
  if (!figures.bootstrap_over_solver) return "";
  const double band = 1.0 + 2.0 / std::sqrt(2.0 * std::max(1, views - 1));
  const double largest =
      std::max(*figures.bootstrap_over_solver, figures.jackknife_over_solver.value_or(0.0));
  const double smallest =
      std::min(*figures.bootstrap_over_solver,
               figures.jackknife_over_solver.value_or(*figures.bootstrap_over_solver));
  if (largest > band) {
    return fmt::format(
        "The views differ from each other by {:.1f} times what the noise model allows, which the "
        "stated covariance includes.",
        largest);
  }
  if (smallest < 1.0 / band) {
    return fmt::format(
        "The views agree {:.1f} times better than the noise model allows: it is cautious, "
        "or the views are too similar to show an error that they share.",
        1.0 / smallest);
  }
  return "They agree within the statistical uncertainty of so many views.";
}

}  // namespace

std::string DescribeChecks(const TrustFigures& figures, int views) {
  if (views < 2) return "One view alone: its answer cannot be compared with any other.";
  std::string text = CrossValidationText(figures) + SigmasText(figures);
  if (views == 2) text += "Two views are too few for a bootstrap.";
  text += ComparisonText(figures, views);
  if (!figures.outlier_views.empty()) {
    const std::size_t outliers = figures.outlier_views.size();
    text += fmt::format(" {} view{} with the others; see the diagnostics.", outliers,
                        outliers == 1 ? " disagrees" : "s disagree");
  }
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

std::string OutlierText(const std::string& name, const ViewTrust& view,
                        const TrustFigures& figures) {
  return fmt::format(
      "{} disagrees with the other views: under their answer its corners are off by {}, those of "
      "all views by {}; was the board still, and is its scan of the same moment?",
      name, ErrorText(view.held_out_m, view.held_out_px),
      ErrorText(figures.held_out_rmse_m, figures.held_out_rmse_px));
}

}  // namespace sextant
