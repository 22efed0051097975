// SPDX-License-Identifier: Apache-2.0
#include "report/page/photo_svg.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text/escape.h"
#include "report/page/base64.h"
#include "report/page/palette.h"

namespace sextant {
namespace {

std::string PathOf(const std::vector<Eigen::Vector2d>& outline) {
  std::string path;
  for (const Eigen::Vector2d& point : outline) {
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', point.x(), point.y());
  }
  return path.empty() ? path : path + "Z";
}

// One path for each colour, as dots of a round pen. Whole pixels are enough for dots, and relative
// steps take half of the text.
std::string DotsSvg(const PagePhoto& photo) {
  std::array<std::string, kPalette.size()> paths;
  std::array<Eigen::Vector2i, kPalette.size()> last;
  for (const PageDot& dot : photo.dots) {
    const double share = std::clamp(static_cast<double>(dot.nearness), 0.0, 1.0);
    const auto bin = static_cast<std::size_t>(std::lround(share * (kPalette.size() - 1)));
    const Eigen::Vector2i at(std::lround(dot.pixel.x()), std::lround(dot.pixel.y()));
    if (paths[bin].empty()) {
      paths[bin] = fmt::format("M{} {}h0", at.x(), at.y());
    } else {
      const Eigen::Vector2i step = at - last[bin];
      paths[bin] += fmt::format("m{}{}{}h0", step.x(), step.y() < 0 ? "" : " ", step.y());
    }
    last[bin] = at;
  }
  const double diameter = std::max(2.0, photo.width_px / 300.0);
  std::string svg = fmt::format("<g class=\"scan\" stroke-width=\"{:.1f}\">\n", diameter);
  for (std::size_t bin = 0; bin < paths.size(); ++bin) {
    if (paths[bin].empty()) continue;
    svg += fmt::format("<path stroke=\"{}\" d=\"{}\"/>\n", kPalette[bin], paths[bin]);
  }
  return svg + "</g>\n";
}

// A dark rim keeps the lines visible on any photo.
std::string OutlineSvg(const std::vector<Eigen::Vector2d>& outline, std::string_view kind,
                       double width) {
  if (outline.empty()) return {};
  const std::string path = PathOf(outline);
  return fmt::format(
      "<path class=\"rim\" stroke-width=\"{:.1f}\" d=\"{}\"/><path class=\"{}\" "
      "stroke-width=\"{:.1f}\"{} d=\"{}\"/>\n",
      2.2 * width, path, kind, width,
      kind == "by-lidar"
          ? fmt::format(" stroke-dasharray=\"{0:.0f} {1:.0f}\"", 4.0 * width, 2.5 * width)
          : "",
      path);
}

std::string PhotoLegend(const PagePhoto& photo) {
  std::string html =
      "<p class=\"legend\"><span><i class=\"line by-camera\"></i>board by the camera</span>"
      "<span><i class=\"line by-lidar\"></i>board by the LiDAR</span>";
  if (!photo.dots.empty()) {
    html += fmt::format(
        "<span class=\"ranges\">{:.1f} m<i class=\"ramp\"></i>{:.1f} m from the LiDAR</span>",
        photo.nearest_m, photo.farthest_m);
  }
  return html + "</p>\n";
}

}  // namespace

std::string PhotoHtml(const PageView& view) {
  if (!view.photo) return {};
  const PagePhoto& photo = *view.photo;
  const double width = std::max(1.5, photo.width_px / 500.0);
  std::string outlines;
  for (const PageBoard& board : view.boards) {
    outlines += OutlineSvg(board.camera_in_px, "by-camera", width);
    outlines += OutlineSvg(board.lidar_in_px, "by-lidar", width);
  }
  return fmt::format(
      "<figure class=\"photo\"><svg viewBox=\"-0.5 -0.5 {0} {1}\" role=\"img\" "
      "aria-label=\"Photo of view {2} with its scan\">\n<image x=\"-0.5\" y=\"-0.5\" "
      "width=\"{0}\" height=\"{1}\" preserveAspectRatio=\"none\" "
      "href=\"data:image/jpeg;base64,{3}\"/>\n{4}<g class=\"outlines\">\n{5}</g></svg>\n{6}"
      "</figure>\n",
      photo.width_px, photo.height_px, HtmlText(view.name), Base64(photo.jpeg), DotsSvg(photo),
      outlines, PhotoLegend(photo));
}

std::string CoverageHtml(const PageCoverage& coverage) {
  if (coverage.width_px <= 0 || coverage.height_px <= 0) return {};
  const double line = coverage.width_px / 400.0;
  const double cell = coverage.width_px / 8.0;
  std::string grid;
  for (int k = 1; k < 8; ++k) grid += fmt::format("M{:.0f} 0v{}", k * cell, coverage.height_px);
  for (double y = cell; y < coverage.height_px; y += cell) {
    grid += fmt::format("M0 {:.0f}h{}", y, coverage.width_px);
  }
  std::string svg =
      fmt::format("<path class=\"grid\" stroke-width=\"{:.1f}\" d=\"{}\"/>\n", 0.5 * line, grid);
  for (const std::vector<Eigen::Vector2d>& outline : coverage.outlines) {
    svg += fmt::format("<path class=\"covered\" stroke-width=\"{:.1f}\" d=\"{}\"/>\n", line,
                       PathOf(outline));
  }
  return fmt::format(
      "<figure class=\"plot\"><h3>Boards in the image of {0}</h3><svg class=\"frame\" "
      "viewBox=\"-0.5 -0.5 {1} {2}\" role=\"img\" aria-label=\"Boards in the image of {0}\">\n"
      "{3}</svg>\n<figcaption>{4:.0f} percent of the image, in cells of an eighth of its width, "
      "had a board in it. Intrinsics and rotation are best known where boards were.</figcaption>"
      "</figure>\n",
      HtmlText(coverage.camera), coverage.width_px, coverage.height_px, svg,
      100.0 * coverage.share);
}

}  // namespace sextant
