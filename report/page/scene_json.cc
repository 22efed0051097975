// SPDX-License-Identifier: Apache-2.0
#include "report/page/scene_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text/escape.h"
#include "base/text/printable.h"
#include "report/page/base64.h"
#include "report/page/palette.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

Json PointsJson(const std::vector<Eigen::Vector3d>& points) {
  Json array = Json::array();
  for (const Eigen::Vector3d& point : points) {
    for (const double value : point) array.push_back(std::round(1e4 * value) / 1e4);
  }
  return array;
}

// Requires its pose.
Json SensorJson(const PageSensor& sensor) {
  std::vector<Eigen::Vector3d> frustum;
  const Rigid3d& base_from_sensor = *sensor.base_from_sensor;
  for (const Eigen::Vector3d& corner : sensor.frustum) {
    frustum.push_back(base_from_sensor * corner);
  }
  const Eigen::Matrix3d axes = base_from_sensor.rotation.toRotationMatrix();
  return {{"name", PrintableLine(sensor.name)},
          {"camera", sensor.is_camera},
          {"origin", PointsJson({base_from_sensor.translation})},
          {"axes", PointsJson({axes.col(0), axes.col(1), axes.col(2)})},
          {"frustum", PointsJson(frustum)}};
}

void AppendInt16(std::int16_t value, std::string& bytes) {
  const auto bits = static_cast<std::uint16_t>(value);
  bytes += static_cast<char>(bits & 0xffU);
  bytes += static_cast<char>(bits >> 8U);
}

Json ScanJson(const PageScan& scan) {
  float reach = 0.0F;
  for (const Eigen::Vector3f& point : scan.in_base) {
    reach = std::max(reach, point.cwiseAbs().maxCoeff());
  }
  const float unit = std::max(0.001F, reach / 32767.0F);
  std::string xyz;
  for (const Eigen::Vector3f& point : scan.in_base) {
    for (const float value : point) {
      AppendInt16(static_cast<std::int16_t>(std::lround(value / unit)), xyz);
    }
  }
  Json json = {{"count", scan.in_base.size()}, {"unit_m", unit}, {"xyz", Base64(xyz)}};
  if (!scan.intensity.empty()) {
    json["intensity"] =
        Base64({reinterpret_cast<const char*>(scan.intensity.data()), scan.intensity.size()});
  }
  if (!scan.colour.empty()) {
    json["rgb"] =
        Base64({reinterpret_cast<const char*>(scan.colour.data()), 3 * scan.colour.size()});
  }
  return json;
}

Json ViewJson(const PageView& view) {
  Json json = {{"name", PrintableLine(view.name)}, {"kept", view.is_kept}};
  Json boards = Json::array();
  for (const PageBoard& board : view.boards) {
    boards.push_back({{"name", PrintableLine(board.name)},
                      {"camera", PointsJson(board.by_camera)},
                      {"lidar", PointsJson(board.by_lidar)}});
  }
  json["boards"] = std::move(boards);
  if (view.scan && !view.scan->in_base.empty()) json["scan"] = ScanJson(*view.scan);
  return json;
}

}  // namespace

std::string SceneJson(const ReportPage& page) {
  Json json = {{"palette", Json::array()}, {"sensors", Json::array()}, {"views", Json::array()}};
  for (const std::string_view colour : kPalette) json["palette"].push_back(colour);
  for (const PageSensor& sensor : page.sensors) {
    if (sensor.base_from_sensor) json["sensors"].push_back(SensorJson(sensor));
  }
  for (const PageView& view : page.views) json["views"].push_back(ViewJson(view));
  if (page.selected) json["selected"] = *page.selected;
  return ScriptJson(json);
}

}  // namespace sextant
