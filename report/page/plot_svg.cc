// SPDX-License-Identifier: Apache-2.0
#include "report/page/plot_svg.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <string_view>

#include "base/text/escape.h"
#include "report/page/plot_axis.h"

namespace sextant {
namespace {

constexpr double kPlotWidth = 520.0;
constexpr double kPlotHeight = 300.0;
constexpr double kLeft = 58.0;
constexpr double kRight = 20.0;
constexpr double kTop = 12.0;
constexpr double kBottom = 46.0;

// Colours of Okabe and Ito (2008), dark enough on white; each with a mark of its own.
constexpr std::array<std::string_view, 4> kColours = {"#0072b2", "#c2500a", "#007a5a", "#7a4a8a"};

// A circle, a square, a triangle or a cross about the place.
std::string MarkSvg(std::size_t kind, double x, double y) {
  switch (kind % kColours.size()) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.6\"/>", x, y);
    case 1:
      return fmt::format("<path d=\"M{:.1f} {:.1f}h6.6v6.6h-6.6z\"/>", x - 3.3, y - 3.3);
    case 2:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l4.2 7.2h-8.4z\"/>", x, y - 4.4);
    default:
      return fmt::format("<path d=\"M{:.1f} {:.1f}l7 7m0-7l-7 7\" stroke-width=\"2\"/>", x - 3.5,
                         y - 3.5);
  }
}

struct PlotFrame {
  PlotAxis x;
  PlotAxis y;

  double X(double value) const { return kLeft + x.Share(value) * (kPlotWidth - kLeft - kRight); }
  double Y(double value) const {
    return kPlotHeight - kBottom - y.Share(value) * (kPlotHeight - kTop - kBottom);
  }
};

std::string AxesSvg(const PlotFrame& frame, const PagePlot& plot) {
  std::string svg;
  for (const double tick : frame.y.ticks()) {
    const double y = frame.Y(tick);
    svg += fmt::format(
        "<path class=\"grid\" d=\"M{} {:.1f}H{}\"/><text x=\"{}\" y=\"{:.1f}\" "
        "text-anchor=\"end\">{}</text>\n",
        kLeft, y, kPlotWidth - kRight, kLeft - 7.0, y + 4.0, frame.y.Text(tick));
  }
  const double bottom = kPlotHeight - kBottom;
  for (const double tick : frame.x.ticks()) {
    const double x = frame.X(tick);
    svg += fmt::format(
        "<path class=\"tick\" d=\"M{:.1f} {}v5\"/><text x=\"{:.1f}\" y=\"{}\" "
        "text-anchor=\"middle\">{}</text>\n",
        x, bottom, x, bottom + 18.0, frame.x.Text(tick));
  }
  svg +=
      fmt::format("<path class=\"tick\" d=\"M{} {}H{}\"/>\n", kLeft, bottom, kPlotWidth - kRight);
  svg +=
      fmt::format("<text class=\"axis\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                  0.5 * (kLeft + kPlotWidth - kRight), kPlotHeight - 8.0, HtmlText(plot.x_label));
  svg += fmt::format(
      "<text class=\"axis\" transform=\"translate(14 {}) rotate(-90)\" "
      "text-anchor=\"middle\">{}</text>\n",
      0.5 * (kTop + bottom), HtmlText(plot.y_label));
  return svg;
}

std::string SeriesSvg(const PlotFrame& frame, const PageSeries& series, std::size_t kind) {
  const std::string_view colour = kColours[kind % kColours.size()];
  std::string svg = fmt::format("<g fill=\"{0}\" stroke=\"{0}\">", colour);
  if (series.is_line) {
    svg += "<path fill=\"none\" stroke-width=\"1.8\" d=\"";
    char command = 'M';
    for (const Eigen::Vector2d& point : series.points) {
      svg += fmt::format("{}{:.1f} {:.1f}", command, frame.X(point.x()), frame.Y(point.y()));
      command = 'L';
    }
    svg += "\"/>";
  }
  svg += series.is_line ? "<g>" : "<g fill-opacity=\".65\" stroke-width=\".5\">";
  for (const Eigen::Vector2d& point : series.points) {
    svg += MarkSvg(kind, frame.X(point.x()), frame.Y(point.y()));
  }
  return svg + "</g></g>\n";
}

std::string LegendHtml(const std::vector<PageSeries>& all) {
  if (all.size() < 2) return {};
  std::string html = "<p class=\"legend\">";
  for (std::size_t i = 0; i < all.size(); ++i) {
    html += fmt::format(
        "<span><svg width=\"14\" height=\"14\" viewBox=\"-7 -7 14 14\" aria-hidden=\"true\">"
        "<g fill=\"{0}\" stroke=\"{0}\">{1}</g></svg>{2}</span>",
        kColours[i % kColours.size()], MarkSvg(i, 0.0, 0.0), HtmlText(all[i].name));
  }
  return html + "</p>\n";
}

std::vector<PageSeries> DrawableOf(const PagePlot& plot) {
  std::vector<PageSeries> drawable;
  for (const PageSeries& series : plot.series) {
    PageSeries kept{.name = series.name, .is_line = series.is_line};
    for (const Eigen::Vector2d& point : series.points) {
      if (point.allFinite() && (!plot.is_log_y || point.y() > 0.0)) kept.points.push_back(point);
    }
    if (!kept.points.empty()) drawable.push_back(std::move(kept));
  }
  return drawable;
}

}  // namespace

std::string PlotHtml(const PagePlot& plot) {
  const std::vector<PageSeries> drawable = DrawableOf(plot);
  if (drawable.empty()) return {};
  std::vector<double> x;
  std::vector<double> y;
  for (const PageSeries& series : drawable) {
    for (const Eigen::Vector2d& point : series.points) {
      x.push_back(point.x());
      y.push_back(point.y());
    }
  }
  const PlotFrame frame{PlotAxis(x, false), PlotAxis(y, plot.is_log_y)};
  std::string svg;
  for (std::size_t i = 0; i < drawable.size(); ++i) svg += SeriesSvg(frame, drawable[i], i);
  const std::string title = HtmlText(plot.title);
  std::string html = fmt::format(
      "<figure class=\"plot\"><h3>{0}</h3>\n{1}<svg viewBox=\"0 0 {2} {3}\" role=\"img\" "
      "aria-label=\"{0}\">\n{4}{5}</svg>\n",
      title, LegendHtml(drawable), kPlotWidth, kPlotHeight, AxesSvg(frame, plot), svg);
  if (!plot.note.empty()) {
    html += fmt::format("<figcaption>{}</figcaption>\n", HtmlText(plot.note));
  }
  return html + "</figure>\n";
}

}  // namespace sextant
