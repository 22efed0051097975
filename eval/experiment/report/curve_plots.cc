// SPDX-License-Identifier: Apache-2.0
// Plots of trials rather than of statistics along an axis: cumulative distributions of an error,
// coverage of stated covariances, and accuracy against time.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/text/escape.h"
#include "eval/experiment/report/plot_style.h"
#include "eval/experiment/report/report.h"
#include "eval/statistics/statistics.h"

namespace sextant {
namespace {

/// The data block and the entry of one line.
struct CurveLine {
  std::string name;
  std::string data;
};

std::string CurveName(const Experiment& experiment, const PlotSpec& plot,
                      const Condition& condition, const CellKey& cell) {
  const std::string subject = SubjectText(condition, cell);
  const bool is_only = !plot.condition.empty() || experiment.conditions.size() == 1;
  return is_only ? subject : subject + ", " + condition.name;
}

template <class LineOfCell>
std::vector<CurveLine> LinesOfCells(const Experiment& experiment, const PlotSpec& plot,
                                    const ReportData& data, const LineOfCell& line_of) {
  std::vector<CurveLine> lines;
  for (std::size_t c = 0; c < experiment.conditions.size(); ++c) {
    const Condition& condition = experiment.conditions[c];
    if (!plot.condition.empty() && condition.name != plot.condition) continue;
    for (std::size_t cell = 0; cell < data.cells(c).size(); ++cell) {
      CurveLine line = line_of(c, cell);
      if (line.data.empty()) continue;
      line.name = CurveName(experiment, plot, condition, data.cells(c)[cell]) + line.name;
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

std::string CommandsOf(const PlotSpec& plot, const std::vector<CurveLine>& lines,
                       const std::string& settings, const char* with, const std::string& first) {
  if (lines.empty()) return {};
  std::string text;
  std::string series = first;
  std::size_t longest = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    longest = std::max(longest, lines[i].name.size());
    text += fmt::format("$line{} << EOD\n{}EOD\n", i, lines[i].data);
    series += fmt::format("{}$line{} {} {} title {}", series.empty() ? "" : ", \\\n  ", i, with,
                          LineStyle(i), GnuplotText(lines[i].name));
  }
  return text + PlotFrame(plot, longest) + settings + "plot " + series + "\n";
}

std::vector<double> SortedNumbers(const std::vector<double>& values) {
  std::vector<double> sorted;
  std::ranges::copy_if(values, std::back_inserter(sorted), [](double v) { return !std::isnan(v); });
  std::ranges::sort(sorted);
  return sorted;
}

// A step for each of at most kMaxSteps values, evenly spread over the ranks. Markers are few.
CurveLine CdfOf(const std::vector<double>& values, const PlotSpec& plot) {
  constexpr std::size_t kMaxSteps = 400;
  const std::vector<double> sorted = SortedNumbers(values);
  if (sorted.empty()) return {};
  CurveLine line;
  const auto all = static_cast<double>(values.size());
  const std::size_t steps = std::min(kMaxSteps, sorted.size());
  double before = 0.0;
  if (!plot.log_x) line.data += "0 0\n";
  for (std::size_t i = 0; i < steps; ++i) {
    const std::size_t rank = steps == 1 ? 0 : i * (sorted.size() - 1) / (steps - 1);
    const double share = static_cast<double>(rank + 1) / all;
    const double x = sorted[rank];
    if (!plot.log_x || x > 0.0) line.data += fmt::format("{} {}\n{} {}\n", x, before, x, share);
    before = share;
  }
  const double share = static_cast<double>(sorted.size()) / all;
  const double end = std::max(plot.max, sorted.back());
  line.data += fmt::format("{} {}\n", end, share);
  if (plot.max > 0.0) {
    const double area = std::accumulate(
        sorted.begin(), sorted.end(), 0.0,
        [&](double sum, double v) { return sum + std::max(0.0, 1.0 - v / plot.max); });
    line.name = fmt::format(" (area {:.2f})", area / all);
  }
  if (sorted.size() < values.size()) {
    line.name += fmt::format(" ({}/{} answered)", sorted.size(), values.size());
  }
  return line;
}

std::string CdfCommands(const Experiment& experiment, const PlotSpec& plot,
                        const ReportData& data) {
  const std::vector<CurveLine> lines =
      LinesOfCells(experiment, plot, data, [&](std::size_t c, std::size_t cell) {
        return CdfOf(data.values(c, plot.metric)[cell], plot);
      });
  const std::string range =
      plot.max > 0.0 ? fmt::format("set xrange [{}:{}]\n", plot.log_x ? "*" : "0", plot.max) : "";
  return CommandsOf(plot, lines, range + "set yrange [0:1.02]\n",
                    "using 1:2 with linespoints pi 97", "");
}

// P(chi-square with 6 degrees of freedom <= x).
double LevelOf(double x) {
  const double half = 0.5 * x;
  return 1.0 - std::exp(-half) * (1.0 + half + 0.5 * half * half);
}

CurveLine CoverageOf(const std::vector<double>& nees) {
  constexpr std::array<double, 11> kLevels = {0.1, 0.2, 0.3, 0.4,  0.5, 0.6,
                                              0.7, 0.8, 0.9, 0.95, 0.99};
  const std::vector<double> sorted = SortedNumbers(nees);
  if (sorted.empty()) return {};
  CurveLine line;
  for (const double level : kLevels) {
    const auto within = static_cast<std::uint64_t>(
        std::ranges::count_if(sorted, [&](double x) { return LevelOf(x) <= level; }));
    const Interval interval = WilsonInterval(within, sorted.size());
    line.data += fmt::format("{} {} {} {}\n", level,
                             static_cast<double>(within) / static_cast<double>(sorted.size()),
                             interval.low, interval.high);
  }
  if (sorted.size() < nees.size()) {
    line.name = fmt::format(" ({}/{} answered)", sorted.size(), nees.size());
  }
  return line;
}

std::string CoverageCommands(const Experiment& experiment, const PlotSpec& plot,
                             const ReportData& data) {
  const std::vector<CurveLine> lines =
      LinesOfCells(experiment, plot, data, [&](std::size_t c, std::size_t cell) {
        return CoverageOf(data.values(c, plot.metric)[cell]);
      });
  return CommandsOf(plot, lines, "set xrange [0:1]\nset yrange [0:1]\n",
                    "using 1:2:3:4 with yerrorlines",
                    "x with lines lc rgb '#888888' lw 1 title 'as stated'");
}

std::string TimeCommands(const Experiment& experiment, const PlotSpec& plot,
                         const ReportData& data) {
  const std::vector<CurveLine> lines =
      LinesOfCells(experiment, plot, data, [&](std::size_t c, std::size_t cell) {
        const Condition& condition = experiment.conditions[c];
        const std::string subject = SubjectText(condition, data.cells(c)[cell]);
        const auto row = std::ranges::find_if(data.timing(), [&](const TimingRow& r) {
          return r.condition == condition.name && r.subject == subject;
        });
        const Figure& figure = data.figures(c, plot.y)[cell];
        if (row == data.timing().end() || !std::isfinite(figure.value)) return CurveLine{};
        const Interval interval = figure.interval.value_or(Interval{figure.value, figure.value});
        return CurveLine{{},
                         fmt::format("{} {} {} {} {} {}\n", row->median_us, figure.value,
                                     row->p25_us, row->p75_us, interval.low, interval.high)};
      });
  return CommandsOf(plot, lines, "set offsets graph 0.05, graph 0.05, graph 0.05, graph 0.05\n",
                    "using 1:2:3:4:5:6 with xyerrorbars", "");
}

}  // namespace

std::string CurveCommands(const Experiment& experiment, const PlotSpec& plot,
                          const ReportData& data) {
  switch (plot.type) {
    case PlotType::kCdf:
      return CdfCommands(experiment, plot, data);
    case PlotType::kCoverage:
      return CoverageCommands(experiment, plot, data);
    case PlotType::kTime:
      return TimeCommands(experiment, plot, data);
    case PlotType::kLines:
      break;
  }
  return {};
}

}  // namespace sextant
