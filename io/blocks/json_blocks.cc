// SPDX-License-Identifier: Apache-2.0
#include "io/blocks/json_blocks.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "base/units.h"
#include "geometry/intrinsics.h"
#include "io/blocks/camera_block.h"
#include "io/text/degrees.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

Json Center(const Eigen::Vector2d& center) { return {center.x(), center.y()}; }

Json TagJson(const BoardTag& tag) {
  return {{"family", tag.family},
          {"id", tag.id},
          {"edge_m", tag.edge_m},
          {"center_in_board_m", Center(tag.center_in_board_m)},
          {"rotation_deg", ExactDegrees(tag.rotation_rad)}};
}

}  // namespace

Json PoseJson(const Rigid3d& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  const Eigen::Vector3d& t = pose.translation;
  const EulerZyx euler = ToEulerZyx(q);
  const Eigen::Matrix4d matrix = pose.Matrix();
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i) {
    rows.push_back({matrix(i, 0), matrix(i, 1), matrix(i, 2), matrix(i, 3)});
  }
  return {
      {"matrix", std::move(rows)},
      {"translation_m", {t.x(), t.y(), t.z()}},
      {"quaternion_wxyz", {q.w(), q.x(), q.y(), q.z()}},
      {"euler_zyx_deg",
       {euler.yaw * kDegPerRad, euler.pitch * kDegPerRad, euler.roll * kDegPerRad}},
  };
}

Json CameraJson(const Camera& camera) {
  const std::span<const double> distortion = WrittenDistortion(camera);
  Json json = {{"model", CameraModelName(camera.model)},
               {"width_px", camera.width_px},
               {"height_px", camera.height_px},
               {"fx_px", camera.fx_px},
               {"fy_px", camera.fy_px},
               {"cx_px", camera.cx_px},
               {"cy_px", camera.cy_px},
               {"distortion", std::vector<double>(distortion.begin(), distortion.end())}};
  if (camera.skew_px != 0.0) json["skew_px"] = camera.skew_px;
  if (camera.xi != 0.0) json["xi"] = camera.xi;
  if (camera.alpha != 0.0) json["alpha"] = camera.alpha;
  return json;
}

Json BoardJson(const Board& board) {
  Json json = {{"id", board.id}};
  if (!board.name.empty()) json["name"] = board.name;
  json["top_right_m"] = board.top_right_m;
  json["right_bottom_m"] = board.right_bottom_m;
  json["thickness_m"] = board.thickness_m;
  if (board.hole) {
    json["hole"] = {{"width_m", board.hole->width_m},
                    {"height_m", board.hole->height_m},
                    {"center_in_board_m", Center(board.hole->center_in_board_m)}};
  }
  for (const RoundHole& hole : board.round_holes) {
    json["round_holes"].push_back(
        {{"radius_m", hole.radius_m}, {"center_in_board_m", Center(hole.center_in_board_m)}});
  }
  for (const BoardTag& tag : board.tags) json["tags"].push_back(TagJson(tag));
  if (board.checker) {
    json["checker"] = {{"inner_columns", board.checker->inner_columns},
                       {"inner_rows", board.checker->inner_rows},
                       {"square_m", board.checker->square_m},
                       {"center_in_board_m", Center(board.checker->center_in_board_m)}};
    if (board.checker->starts_white) json["checker"]["starts_white"] = true;
    if (board.checker->holds_tags) json["checker"]["holds_tags"] = true;
  }
  return json;
}

}  // namespace sextant
