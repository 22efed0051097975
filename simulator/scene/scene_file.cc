// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/scene_file.h"

#include <fmt/core.h>

#include <cmath>

#include "base/units.h"
#include "io/blocks/board_block.h"
#include "io/blocks/camera_block.h"
#include "io/text/text_file.h"
#include "io/text/yaml_fields.h"
#include "simulator/scene/camera_model.h"
#include "simulator/scene/scene_pose.h"

namespace sextant {
namespace {

using Keys = std::vector<std::string>;

std::string NameAt(YamlFields& in, const YamlNode& node, const std::string& otherwise = {}) {
  return node.Find("name") != nullptr ? in.TextAt(node, "name") : otherwise;
}

// The upright attitude whose forward axis points along `direction`.
EulerZyx Along(const Eigen::Vector3d& direction) {
  const double level = std::hypot(direction.x(), direction.y());
  return {.yaw = level > 0.0 ? std::atan2(direction.y(), direction.x()) : 0.0,
          .pitch = -std::atan2(direction.z(), level)};
}

Eigen::Quaterniond ReadQuaternion(YamlFields& in, const YamlNode& node) {
  double wxyz[4] = {1.0, 0.0, 0.0, 0.0};
  in.Reals(node, "quaternion_wxyz", wxyz);
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  constexpr double kTolerance = 1e-3;
  if (in.ok() && std::abs(q.norm() - 1.0) > kTolerance) {
    in.Fail(node.line, "quaternion_wxyz", "expected a quaternion of length 1");
  }
  // A quaternion that was written with all digits is used bit by bit.
  constexpr double kRounding = 1e-14;
  return std::abs(q.norm() - 1.0) < kRounding ? q : q.normalized();
}

// world_from_object of a map with `position_m` and one of
// - `yaw_deg`, `pitch_deg`, `roll_deg`, as SceneRotation has them (0 where absent);
// - `facing_m` and `roll_deg`: the point in the world that a camera, LiDAR or box looks at, or
//   that sees the front of a board or wall squarely; upright before the roll;
// - `quaternion_wxyz`: the rotation of world_from_object as it is.
// Errors go to `in`.
Rigid3d ReadScenePose(YamlFields& in, const YamlNode& node, SceneAxes axes,
                      bool front_is_backward = false) {
  static const std::vector<std::string> kKeys = {"position_m", "yaw_deg",  "pitch_deg",
                                                 "roll_deg",   "facing_m", "quaternion_wxyz"};
  Rigid3d pose;
  if (!in.IsMap(node, "pose", kKeys)) return pose;
  pose.translation = in.PointAt(node, "position_m");
  const bool has_angles = node.Find("yaw_deg") != nullptr || node.Find("pitch_deg") != nullptr;
  const YamlNode* facing = node.Find("facing_m");
  const YamlNode* quaternion = node.Find("quaternion_wxyz");
  if ((quaternion != nullptr && (facing != nullptr || node.Find("roll_deg") != nullptr)) ||
      (has_angles && (facing != nullptr || quaternion != nullptr))) {
    in.Fail(node.line, "pose",
            "expected one of: yaw_deg, pitch_deg and roll_deg; facing_m and roll_deg; "
            "quaternion_wxyz");
    return pose;
  }
  if (quaternion != nullptr) {
    pose.rotation = ReadQuaternion(in, *quaternion);
    return pose;
  }
  EulerZyx euler;
  if (facing != nullptr) {
    const Eigen::Vector3d toward = in.Point(*facing, "facing_m") - pose.translation;
    if (in.ok() && !(toward.norm() > 0.0)) {
      in.Fail(facing->line, "facing_m", "expected another point than position_m");
    }
    euler = Along(front_is_backward ? -toward : toward);
  } else {
    euler.yaw = kRadPerDeg * in.RealAt(node, "yaw_deg", 0.0);
    euler.pitch = kRadPerDeg * in.RealAt(node, "pitch_deg", 0.0);
  }
  euler.roll = kRadPerDeg * in.RealAt(node, "roll_deg", 0.0);
  pose.rotation = SceneRotation(axes, euler);
  return pose;
}

Surface SurfaceAt(YamlFields& in, const YamlNode& map, std::string_view key, Surface surface) {
  static const Keys kKeys = {"reflectivity", "albedo"};
  const YamlNode* node = map.Find(key);
  if (node == nullptr || !in.IsMap(*node, key, kKeys)) return surface;
  surface.reflectivity = in.RealAt(*node, "reflectivity", surface.reflectivity);
  surface.albedo = in.RealAt(*node, "albedo", surface.albedo);
  return surface;
}

SceneLidar ReadLidar(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"model", "pose"};
  SceneLidar lidar;
  if (!in.IsMap(node, "lidar", kKeys)) return lidar;
  if (node.Find("model") != nullptr) lidar.model = in.TextAt(node, "model");
  lidar.world_from_lidar = ReadScenePose(in, in.Require(node, "pose"), SceneAxes::kForwardIsX);
  return lidar;
}

// Reads one camera, and adds its stereo partner if it has a baseline.
void ReadCamera(YamlFields& in, const YamlNode& node, std::vector<SceneCamera>& cameras) {
  static const Keys kKeys = {
      "name", "model", "intrinsics", "assumed_intrinsics", "pose", "stereo_baseline_m"};
  if (!in.IsMap(node, "camera", kKeys)) return;
  SceneCamera camera;
  if (const YamlNode* name = node.Find("name")) camera.name = in.FileName(*name, "name");
  const YamlNode* intrinsics = node.Find("intrinsics");
  if ((node.Find("model") != nullptr) == (intrinsics != nullptr)) {
    in.Fail(node.line, "camera", "expected either model or intrinsics");
    return;
  }
  if (intrinsics != nullptr) {
    camera.intrinsics = ReadCameraBlock(in, *intrinsics);
  } else {
    camera.model = in.TextAt(node, "model");
  }
  if (const YamlNode* assumed = node.Find("assumed_intrinsics")) {
    camera.assumed_intrinsics = ReadCameraBlock(in, *assumed);
  }
  camera.world_from_cam = ReadScenePose(in, in.Require(node, "pose"), SceneAxes::kForwardIsZ);
  cameras.push_back(camera);
  const double baseline_m = in.RealAt(node, "stereo_baseline_m", 0.0);
  if (baseline_m != 0.0) {
    cameras.push_back(StereoPartner(camera, baseline_m, camera.name + "_right"));
  }
}

Swing ReadSwing(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"axis_in_world", "amplitude_deg", "period_s", "phase_deg"};
  Swing swing;
  if (!in.IsMap(node, "swing", kKeys)) return swing;
  swing.axis_in_world = in.PointAt(node, "axis_in_world");
  swing.amplitude_rad = kRadPerDeg * in.RealAt(node, "amplitude_deg");
  swing.period_s = in.RealAt(node, "period_s");
  swing.phase_rad = kRadPerDeg * in.RealAt(node, "phase_deg", 0.0);
  return swing;
}

SceneBoard ReadBoard(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"board", "pose", "swing", "white", "black"};
  SceneBoard board;
  if (!in.IsMap(node, "boards", kKeys)) return board;
  board.board = ReadBoardBlock(in, in.Require(node, "board"));
  board.world_from_board =
      ReadScenePose(in, in.Require(node, "pose"), SceneAxes::kForwardIsZ, true);
  if (const YamlNode* swing = node.Find("swing")) board.swing = ReadSwing(in, *swing);
  board.white = SurfaceAt(in, node, "white", board.white);
  board.black = SurfaceAt(in, node, "black", board.black);
  return board;
}

SceneWall ReadWall(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"name",    "pose",   "width_m",  "height_m",
                             "surface", "tile_m", "speckle_m"};
  SceneWall wall;
  if (!in.IsMap(node, "wall", kKeys)) return wall;
  wall.name = NameAt(in, node);
  wall.world_from_wall = ReadScenePose(in, in.Require(node, "pose"), SceneAxes::kForwardIsZ, true);
  wall.width_m = in.RealAt(node, "width_m");
  wall.height_m = in.RealAt(node, "height_m");
  wall.surface = SurfaceAt(in, node, "surface", wall.surface);
  wall.tile_m = in.NonNegativeAt(node, "tile_m", wall.tile_m);
  if (const YamlNode* speckle = node.Find("speckle_m")) {
    if (node.Find("tile_m") != nullptr) {
      in.Fail(speckle->line, "speckle_m", "expected either tile_m or speckle_m");
    }
    wall.speckled = true;
    wall.tile_m = in.NonNegativeAt(node, "speckle_m", 0.0);
  }
  return wall;
}

SceneBox ReadBox(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"name", "pose", "size_m", "surface"};
  SceneBox box;
  if (!in.IsMap(node, "box", kKeys)) return box;
  box.name = NameAt(in, node);
  box.world_from_box = ReadScenePose(in, in.Require(node, "pose"), SceneAxes::kForwardIsX);
  box.size_m = in.PointAt(node, "size_m");
  box.surface = SurfaceAt(in, node, "surface", box.surface);
  return box;
}

SceneCylinder ReadCylinder(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"name", "base_m", "radius_m", "height_m", "surface"};
  SceneCylinder cylinder;
  if (!in.IsMap(node, "cylinder", kKeys)) return cylinder;
  cylinder.name = NameAt(in, node);
  cylinder.base_in_world = in.PointAt(node, "base_m");
  cylinder.radius_m = in.RealAt(node, "radius_m");
  cylinder.height_m = in.RealAt(node, "height_m");
  cylinder.surface = SurfaceAt(in, node, "surface", cylinder.surface);
  return cylinder;
}

// The items of an optional list of limited length.
std::vector<const YamlNode*> ItemsAt(YamlFields& in, const YamlNode& root, std::string_view key,
                                     std::size_t most) {
  std::vector<const YamlNode*> items;
  const YamlNode* list = root.Find(key);
  if (list == nullptr || !in.IsSequence(*list, key)) return items;
  if (list->items.size() > most) {
    in.Fail(list->line, key, fmt::format("expected at most {}, got {}", most, list->items.size()));
    return items;
  }
  for (const YamlNode& item : list->items) items.push_back(&item);
  return items;
}

template <class T, class Read>
void ReadList(YamlFields& in, const YamlNode& root, std::string_view key, Read read,
              std::vector<T>& list) {
  for (const YamlNode* item : ItemsAt(in, root, key, kMaxSceneShapes)) {
    list.push_back(read(in, *item));
  }
}

void ReadBoards(YamlFields& in, const YamlNode& root, Scene& scene) {
  std::vector<const YamlNode*> nodes;
  std::vector<Board> boards;
  for (const YamlNode* item : ItemsAt(in, root, "boards", kMaxSceneBoards)) {
    scene.boards.push_back(ReadBoard(in, *item));
    if (!in.ok()) return;
    boards.push_back(scene.boards.back().board);
    nodes.push_back(item->Find("board"));
  }
  RequireDistinctBoards(in, nodes, boards);
}

}  // namespace

Expected<Scene> ReadScene(const std::filesystem::path& path) { return ReadWith(path, ParseScene); }

Expected<Scene> ParseScene(std::string_view text, const std::string& file) {
  static const Keys kKeys = {"sextant_scene", "name",  "lidar",     "cameras",          "boards",
                             "walls",         "boxes", "cylinders", "background_albedo"};
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  YamlFields in(file);
  Scene scene;
  if (in.IsMap(root, "scene", kKeys)) {
    in.IntegerAt(root, "sextant_scene", 1, 1);
    scene.name = NameAt(in, root);
    scene.lidar = ReadLidar(in, in.Require(root, "lidar"));
    for (const YamlNode* item : ItemsAt(in, root, "cameras", kMaxSceneCameras)) {
      ReadCamera(in, *item, scene.cameras);
    }
    ReadBoards(in, root, scene);
    ReadList(in, root, "walls", ReadWall, scene.walls);
    ReadList(in, root, "boxes", ReadBox, scene.boxes);
    ReadList(in, root, "cylinders", ReadCylinder, scene.cylinders);
    scene.background_albedo = in.RealAt(root, "background_albedo", scene.background_albedo);
  }
  if (!in.ok()) return in.TakeError();
  return scene;
}

}  // namespace sextant
