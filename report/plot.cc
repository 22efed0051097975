// SPDX-License-Identifier: Apache-2.0
#include "report/plot.h"

#include <fmt/format.h>

#include "base/text/escape.h"
#include "io/output/output_file.h"
#include "report/gnuplot.h"

namespace sextant {
namespace {

Expected<PlotFormat> FormatOf(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".svg") return PlotFormat::kSvg;
  if (extension == ".png") return PlotFormat::kPng;
  if (extension == ".pdf") return PlotFormat::kPdf;
  return MakeError(
      ErrorCode::kInvalidOption,
      fmt::format("{}: expected a plot that ends in .svg, .png or .pdf", path.string()));
}

struct Residuals {
  std::vector<PairId> ids;
  std::string unit;
  double scale = 1.0;
  bool in_pixels = false;

  const std::vector<double>& Of(const SolveReport& report) const {
    return in_pixels ? report.evaluation.per_pair_px : report.evaluation.per_pair_m;
  }
};

Residuals ResidualsOf(const CalibrationProblem& problem) {
  Residuals residuals;
  if (!problem.pairs_3d3d.empty()) {
    residuals.unit = "mm";
    residuals.scale = 1e3;
    for (const Pair3d3d& pair : problem.pairs_3d3d) residuals.ids.push_back(pair.id);
  } else {
    residuals.unit = "px";
    residuals.in_pixels = true;
    for (const Pair2d3d& pair : problem.pairs_2d3d) residuals.ids.push_back(pair.id);
  }
  return residuals;
}

std::string Ticks(const std::vector<PairId>& ids) {
  constexpr std::size_t kMaxLabels = 40;
  const std::size_t step = ids.size() / kMaxLabels + 1;
  std::vector<std::string> ticks;
  for (std::size_t i = 0; i < ids.size(); i += step) {
    ticks.push_back(fmt::format("'{}.{}.{}' {}", ids[i].view, ids[i].board, ids[i].corner, i));
  }
  return fmt::format("set xtics ({})\n", fmt::join(ticks, ", "));
}

}  // namespace

Expected<void> DrawPlot(const std::string& commands, const std::filesystem::path& path) {
  SEXTANT_ASSIGN_OR_RETURN(const PlotFormat format, FormatOf(path));
  SEXTANT_ASSIGN_OR_RETURN(const std::string picture, RunGnuplot(commands, format));
  return WriteFileAtomically(path, picture);
}

std::string ResidualPlot(const CalibrationProblem& problem,
                         const std::vector<ComparisonRow>& rows) {
  const Residuals residuals = ResidualsOf(problem);
  std::string data;
  std::vector<std::string> series;
  std::vector<const SolveReport*> answers;
  for (const ComparisonRow& row : rows) {
    if (row.report) answers.push_back(&*row.report);
  }
  for (std::size_t k = 0; k < answers.size(); ++k) {
    data += fmt::format("$answer{} << EOD\n", k);
    const std::vector<double>& of_answer = residuals.Of(*answers[k]);
    // The solvers have different positions within each pair, so that equal residuals stay visible.
    const double offset =
        0.7 * ((static_cast<double>(k) + 0.5) / static_cast<double>(answers.size()) - 0.5);
    for (std::size_t i = 0; i < of_answer.size(); ++i) {
      data +=
          fmt::format("{} {}\n", static_cast<double>(i) + offset, of_answer[i] * residuals.scale);
    }
    data += "EOD\n";
    series.push_back(
        fmt::format("$answer{} using 1:2 with impulses lw 3 lc {} notitle, "
                    "$answer{} using 1:2 with points pt 7 ps 0.7 lc {} title {}",
                    k, k + 1, k, k + 1, GnuplotText(answers[k]->solver)));
  }
  return fmt::format(
      "{}{}set key above horizontal noenhanced\nset grid ytics\nset offsets 0, 0, graph 0.05, "
      "0\nset yrange [0:*]\n"
      "set xrange [-0.6:{}]\nset xlabel 'pair (view.board.corner)'\nset ylabel 'residual [{}]'\n"
      "plot {}\n",
      data, Ticks(residuals.ids), static_cast<double>(residuals.ids.size()) - 0.4, residuals.unit,
      fmt::join(series, ", \\\n  "));
}

}  // namespace sextant
