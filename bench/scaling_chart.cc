// SPDX-License-Identifier: Apache-2.0
#include "bench/scaling_chart.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "base/text/escape.h"
#include "eval/statistics/text_table.h"
#include "report/plot.h"

namespace sextant::bench {
namespace {

std::string FormatSeconds(double seconds) {
  if (seconds < 1e-6) return fmt::format("{:.0f} ns", seconds * 1e9);
  if (seconds < 1e-3) return fmt::format("{:.3g} us", seconds * 1e6);
  if (seconds < 1.0) return fmt::format("{:.3g} ms", seconds * 1e3);
  return fmt::format("{:.3g} s", seconds);
}

std::set<double> PlacesOf(const Chart& chart) {
  std::set<double> places;
  for (const Curve& curve : chart.curves) {
    for (const Curve::Point& point : curve.points) places.insert(point.x);
  }
  return places;
}

std::string CellAt(const Chart& chart, const Curve& curve, double x) {
  for (const Curve::Point& point : curve.points) {
    if (point.x != x) continue;
    return chart.rates ? fmt::format("{:.0f}/s", chart.amount / point.cost.seconds)
                       : FormatSeconds(point.cost.seconds);
  }
  return {};
}

// The exponent of the growth between the last two points; 1 is linear.
std::string GrowthOf(const Curve& curve) {
  if (curve.points.size() < 2) return {};
  const Curve::Point& a = curve.points[curve.points.size() - 2];
  const Curve::Point& b = curve.points.back();
  const double exponent = std::log(b.cost.seconds / a.cost.seconds) / std::log(b.x / a.x);
  return fmt::format("x^{:.2f}", exponent);
}

// Memory at the first and at the last point.
std::string MemoryOf(const Curve& curve) {
  if (curve.points.empty()) return {};
  const auto text = [](double mb) { return fmt::format("{:.{}f}", mb, mb < 10.0 ? 1 : 0); };
  return fmt::format("{} to {}", text(curve.points.front().cost.peak_mb),
                     text(curve.points.back().cost.peak_mb));
}

double HeightOf(const Chart& chart, const Cost& cost) {
  return chart.rates ? chart.amount / cost.seconds : cost.seconds;
}

std::string Panel(const Chart& chart, const std::string& y_label, int column, bool from_zero) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < chart.curves.size(); ++i) {
    lines.push_back(
        fmt::format("$curve{} using 1:{} with linespoints pt 7 ps 0.5 lw 1.5 lc {} "
                    "title {}",
                    i, column, i + 1, GnuplotText(chart.curves[i].name)));
  }
  return fmt::format("set ylabel {}\n{}plot {}\n", GnuplotText(y_label),
                     from_zero ? "unset logscale y\nset yrange [0:*]\nset format y '%g'\n"
                               : "set logscale y\nset yrange [*:*]\nset format y '%.0s%c'\n",
                     fmt::join(lines, ", \\\n  "));
}

}  // namespace

Expected<void> DrawChart(const Chart& chart, const std::filesystem::path& folder) {
  std::string commands;
  for (std::size_t i = 0; i < chart.curves.size(); ++i) {
    commands += fmt::format("$curve{} << EOD\n", i);
    for (const Curve::Point& point : chart.curves[i].points) {
      commands +=
          fmt::format("{} {} {}\n", point.x, HeightOf(chart, point.cost), point.cost.peak_mb);
    }
    commands += "EOD\n";
  }
  commands += fmt::format(
      "set multiplot layout 1,2\nset grid\nset key above left maxrows 4 noenhanced\nset xlabel "
      "{}\n{}set offsets graph 0.03, graph 0.03, 0, 0\n",
      GnuplotText(chart.x),
      chart.log_x ? "set logscale x\nset format x '%.0s%c'\n"
                  : fmt::format("set xtics ({})\n", fmt::join(PlacesOf(chart), ", ")));
  commands += Panel(chart, chart.rates ? "trials a second" : "seconds", 2, chart.rates);
  commands += Panel(chart, "memory [MB]", 3, true);
  commands += "unset multiplot\n";
  for (const char* extension : {".svg", ".png"}) {
    SEXTANT_RETURN_IF_ERROR(DrawPlot(commands, folder / (chart.name + extension)));
  }
  return {};
}

std::string ChapterOf(const Chart& chart) {
  const std::set<double> places = PlacesOf(chart);
  std::vector<std::string> heading = {chart.x};
  for (const double x : places) heading.push_back(fmt::format("{:.7g}", x));
  const bool grows = chart.log_x && !chart.rates;
  if (grows) heading.push_back("grows as");
  heading.push_back("memory [MB]");
  TextTable table(heading);
  for (const Curve& curve : chart.curves) {
    std::vector<std::string> row = {curve.name};
    for (const double x : places) row.push_back(CellAt(chart, curve, x));
    if (grows) row.push_back(GrowthOf(curve));
    row.push_back(MemoryOf(curve));
    table.AddRow(row);
  }
  return fmt::format("## {}\n\n{}\n\n![{}](scaling/{}.svg)\n\n{}", chart.title, chart.text,
                     chart.title, chart.name, table.Markdown());
}

}  // namespace sextant::bench
