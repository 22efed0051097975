// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>

#include "base/text/escape.h"
#include "eval/experiment/report/plot_style.h"
#include "eval/experiment/report/report.h"

namespace sextant {
namespace {

struct Point {
  double x = 0.0;
  Figure figure;
};

// The lines of the plot with their points, in order of appearance.
using Lines = std::vector<std::pair<std::string, std::vector<Point>>>;

std::vector<Point>& LineOf(const std::string& name, Lines& lines) {
  const auto found =
      std::find_if(lines.begin(), lines.end(), [&name](const auto& l) { return l.first == name; });
  if (found != lines.end()) return found->second;
  return lines.emplace_back(name, std::vector<Point>()).second;
}

std::optional<double> NumberOf(const std::string& text) {
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size()) return std::nullopt;
  return value;
}

// Axis values that are not numbers are numbered in order of appearance.
double PlaceOn(const Experiment& experiment, const Condition& condition, const std::string& axis,
               std::map<std::string, double>& named) {
  const auto at = static_cast<std::size_t>(
      std::find(experiment.axes.begin(), experiment.axes.end(), axis) - experiment.axes.begin());
  if (const std::optional<double> number = NumberOf(condition.place[at])) return *number;
  return named.emplace(condition.place[at], static_cast<double>(named.size())).first->second;
}

Lines CollectLines(const Experiment& experiment, const PlotSpec& plot, const ReportData& data,
                   std::map<std::string, double>& named) {
  const bool by_index = plot.x == "index";
  Lines lines;
  for (std::size_t c = 0; c < experiment.conditions.size(); ++c) {
    const Condition& condition = experiment.conditions[c];
    if (!plot.condition.empty() && condition.name != plot.condition) continue;
    const std::string place = PlaceWithout(experiment, condition, plot.x);
    const std::vector<Figure>& figures = data.figures(c, plot.y);
    for (std::size_t cell = 0; cell < figures.size(); ++cell) {
      CellKey key = data.cells(c)[cell];
      const double x = by_index ? key.index : PlaceOn(experiment, condition, plot.x, named);
      if (by_index) key.index = 0;
      const double value = figures[cell].value;
      if (!std::isfinite(value) || (plot.log_y && value <= 0.0) || (plot.log_x && x <= 0.0)) {
        continue;
      }
      const std::string subject = SubjectText(condition, key);
      const std::string both = subject + (subject.empty() || place.empty() ? "" : ", ") + place;
      LineOf(both, lines).push_back({x, figures[cell]});
    }
  }
  return lines;
}

// gnuplot takes the label of a tick for a format of its position.
std::string TickText(const std::string& label) {
  std::string text;
  for (const char c : label) text += c == '%' ? std::string("%%") : std::string(1, c);
  return GnuplotText(text);
}

std::string DataOf(const Lines& lines, bool log_y) {
  std::string data;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    data += fmt::format("$line{} << EOD\n", i);
    for (const Point& point : lines[i].second) {
      const double value = point.figure.value;
      Interval interval = point.figure.interval.value_or(Interval{value, value});
      if (log_y && interval.low <= 0.0) interval.low = value;
      data += fmt::format("{} {} {} {}\n", point.x, value, interval.low, interval.high);
    }
    data += "EOD\n";
  }
  return data;
}

// Whether the y axis should begin at zero: only if the values then still fill at least half of it.
bool BeginsAtZero(const Lines& lines) {
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  for (const auto& [name, points] : lines) {
    for (const Point& point : points) {
      least = std::min(least, point.figure.value);
      most = std::max(most, point.figure.value);
    }
  }
  return least >= 0.0 && least <= 0.5 * most;
}

}  // namespace

std::string PlotCommands(const Experiment& experiment, const PlotSpec& plot,
                         const ReportData& data) {
  if (plot.type != PlotType::kLines) return CurveCommands(experiment, plot, data);
  std::map<std::string, double> named;
  const Lines lines = CollectLines(experiment, plot, data, named);
  if (lines.empty()) return {};
  std::vector<std::string> series;
  std::size_t longest = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    longest = std::max(longest, lines[i].first.size());
    series.push_back(fmt::format("$line{} using 1:2:3:4 with yerrorlines {} title {}", i,
                                 LineStyle(i), GnuplotText(lines[i].first)));
  }
  std::string ticks;
  for (const auto& [name, x] : named)
    ticks += fmt::format("{}{} {}", ticks.empty() ? "" : ", ", TickText(name), x);
  const char* y_axis = !plot.log_y && BeginsAtZero(lines) ? "set yrange [0:*]\n" : "";
  return fmt::format("{}{}{}{}set offsets graph 0.03, graph 0.03, 0, 0\nplot {}\n",
                     DataOf(lines, plot.log_y), PlotFrame(plot, longest), y_axis,
                     ticks.empty() ? "" : "set xtics noenhanced (" + ticks + ")\n",
                     fmt::join(series, ", \\\n  "));
}

}  // namespace sextant
