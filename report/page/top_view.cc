// SPDX-License-Identifier: Apache-2.0
#include "report/page/top_view.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/text/escape.h"

namespace sextant {
namespace {

constexpr double kTopWidth = 720.0;
constexpr double kTopMargin = 34.0;

constexpr std::string_view kBoardsCaption =
    "<p class=\"legend\"><span><i class=\"line by-camera\"></i>boards by the camera</span><span><i "
    "class=\"line by-lidar\"></i>boards by the LiDAR</span></p><figcaption>From above; the forward "
    "direction of the LiDAR is up. Grey dots: returns of one scan.</figcaption>";
constexpr std::string_view kSensorsCaption =
    "<p class=\"legend\"><span><i class=\"line by-camera\"></i>cameras</span><span><i class=\"line "
    "by-lidar\"></i>LiDARs</span></p><figcaption>From above; the forward direction of the first "
    "LiDAR "
    "is up.</figcaption>";

/// The floor: x of the base frame up in the picture, y to the left.
class Floor {
 public:
  explicit Floor(const ReportPage& page) {
    Extend(Eigen::Vector3d::Zero());
    for (const PageSensor& sensor : page.sensors) {
      if (sensor.base_from_sensor) Extend(sensor.base_from_sensor->translation);
    }
    for (const PageView& view : page.views) {
      for (const PageBoard& board : view.boards) {
        for (const Eigen::Vector3d& corner : board.by_camera) Extend(corner);
        for (const Eigen::Vector3d& corner : board.by_lidar) Extend(corner);
      }
    }
    box_.min().array() -= 0.4;
    box_.max().array() += 0.4;
    scale_ = std::min((kTopWidth - 2.0 * kTopMargin) / box_.sizes().y(), 560.0 / box_.sizes().x());
  }

  double scale() const { return scale_; }
  double reach_m() const { return box_.max().norm(); }
  double height_px() const { return scale_ * box_.sizes().x() + 2.0 * kTopMargin; }
  bool Holds(const Eigen::Vector2d& at) const { return box_.contains(at); }

  /// Pixels of the picture.
  Eigen::Vector2d At(const Eigen::Vector2d& in_base) const {
    return {0.5 * kTopWidth - scale_ * (in_base.y() - box_.center().y()),
            kTopMargin + scale_ * (box_.max().x() - in_base.x())};
  }

 private:
  void Extend(const Eigen::Vector3d& in_base) {
    if (in_base.allFinite()) box_.extend(Eigen::Vector2d(in_base.head<2>()));
  }

  Eigen::AlignedBox2d box_;
  double scale_ = 1.0;
};

std::string Text(const Floor& floor, const Eigen::Vector2d& in_base, const Eigen::Vector2d& off,
                 std::string_view kind, const std::string& text) {
  const Eigen::Vector2d at = floor.At(in_base) + off;
  return fmt::format("<text class=\"{}\" x=\"{:.0f}\" y=\"{:.0f}\">{}</text>\n", kind, at.x(),
                     at.y(), HtmlText(text));
}

std::string CirclesSvg(const Floor& floor) {
  const double step = floor.reach_m() > 12.0 ? 5.0 : 1.0;
  const Eigen::Vector2d origin = floor.At(Eigen::Vector2d::Zero());
  std::string svg;
  for (double range = step; range < floor.reach_m(); range += step) {
    svg += fmt::format("<circle class=\"grid\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"/>",
                       origin.x(), origin.y(), range * floor.scale());
    if (floor.Holds({range, 0.0})) {
      svg += Text(floor, {range, 0.0}, {4.0, -4.0}, "faint", fmt::format("{:g} m", range));
    }
  }
  return svg + "\n";
}

std::string BoardSvg(const Floor& floor, const std::vector<Eigen::Vector3d>& corners,
                     std::string_view kind) {
  std::string path;
  for (const Eigen::Vector3d& corner : corners) {
    const Eigen::Vector2d at = floor.At(corner.head<2>());
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', at.x(), at.y());
  }
  if (path.empty()) return path;
  return fmt::format("<path class=\"{}\" stroke-width=\"2\" d=\"{}Z\"/>\n", kind, path);
}

std::string ScanSvg(const Floor& floor, const std::vector<PageView>& views) {
  const auto view = std::find_if(views.begin(), views.end(),
                                 [](const PageView& v) { return v.is_kept && v.scan; });
  if (view == views.end()) return {};
  constexpr std::size_t kMaxDots = 2500;
  const std::size_t step = view->scan->in_base.size() / kMaxDots + 1;
  std::string path;
  for (std::size_t i = 0; i < view->scan->in_base.size(); i += step) {
    const Eigen::Vector2d in_base = view->scan->in_base[i].head<2>().cast<double>();
    if (!floor.Holds(in_base)) continue;
    const Eigen::Vector2d at = floor.At(in_base);
    path += fmt::format("M{:.0f} {:.0f}h0", at.x(), at.y());
  }
  return fmt::format("<path class=\"returns\" d=\"{}\"/>\n", path);
}

std::string SensorSvg(const Floor& floor, const PageSensor& sensor) {
  if (!sensor.base_from_sensor) return {};
  const Eigen::Vector2d place = sensor.base_from_sensor->translation.head<2>();
  const Eigen::Vector2d at = floor.At(place);
  std::string svg;
  // The rays of the middles of the left and the right side.
  const std::size_t rays = sensor.frustum.size();
  for (const std::size_t k : {3 * rays / 8, 7 * rays / 8}) {
    if (k >= rays) continue;
    const Eigen::Vector3d far = 3.0 * sensor.frustum[k];
    const Eigen::Vector2d to = floor.At((*sensor.base_from_sensor * far).head<2>());
    svg += fmt::format("<path class=\"ray\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>", at.x(), at.y(),
                       to.x(), to.y());
  }
  const std::string_view kind = sensor.is_camera ? "by-camera" : "by-lidar";
  svg +=
      fmt::format("<circle class=\"{}\" stroke-width=\"3\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"6\"/>",
                  kind, at.x(), at.y());
  const Eigen::Vector2d off(sensor.is_camera ? -14.0 : 14.0, 20.0);
  return svg + Text(floor, place, off, sensor.is_camera ? "end" : "start", sensor.name);
}

}  // namespace

std::string TopViewHtml(const ReportPage& page) {
  const Floor floor(page);
  std::string svg = ScanSvg(floor, page.views) + CirclesSvg(floor);
  for (const PageView& view : page.views) {
    for (const PageBoard& board : view.boards) {
      svg += BoardSvg(floor, board.by_camera, "by-camera");
      svg += BoardSvg(floor, board.by_lidar, "by-lidar dashed");
    }
  }
  for (const PageSensor& sensor : page.sensors) svg += SensorSvg(floor, sensor);
  return fmt::format(
      "<figure class=\"top-view\"><svg viewBox=\"0 0 {} {:.0f}\" role=\"img\" "
      "aria-label=\"Sensors and boards from above\">\n{}</svg>\n{}</figure>\n",
      kTopWidth, floor.height_px(), svg, page.views.empty() ? kSensorsCaption : kBoardsCaption);
}

}  // namespace sextant
