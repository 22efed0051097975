// SPDX-License-Identifier: Apache-2.0
#include "simulator/session/validate_scene.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/text/file_name.h"
#include "features/camera/tags/tag_pattern.h"
#include "geometry/board_check.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/scene/camera_model.h"
#include "simulator/scene/scene_crossing.h"
#include "simulator/scene/scene_file.h"
#include "simulator/session/scene_visibility.h"

namespace sextant {
namespace {

Error Invalid(std::string message) { return {ErrorCode::kInvalidInput, std::move(message)}; }

std::string Named(const char* kind, std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, index) : fmt::format("{} '{}'", kind, name);
}

std::string NameOf(const SceneBoard& board) {
  return Named("board", static_cast<std::size_t>(board.board.id), board.board.name);
}

// Keeps the first error; later checks are cheap.
class SceneCheck {
 public:
  explicit SceneCheck(const Scene& scene) : scene_(scene) {}

  Expected<void> Run() {
    CheckCounts();
    CheckLidar();
    for (const SceneCamera& camera : scene_.cameras) CheckCamera(camera);
    for (const SceneBoard& board : scene_.boards) CheckBoard(board);
    CheckShapes();
    if (ok()) CheckSensorsAreFree();
    if (ok()) CheckBoardsAreFree();
    if (ok()) CheckBoardsAreSeen();
    if (error_) return tl::unexpected<Error>(*error_);
    return {};
  }

 private:
  bool ok() const { return !error_; }
  void Fail(Error error) {
    if (ok()) error_ = std::move(error);
  }
  void Require(bool holds, const std::string& what, const std::string& wrong) {
    if (!holds) Fail(Invalid(what + ": " + wrong));
  }
  void RequirePose(const Rigid3d& pose, const std::string& what) {
    if (!pose.IsFinite()) Fail({ErrorCode::kNonFinite, what + ": its pose is not finite"});
    Require(std::abs(pose.rotation.norm() - 1.0) < 1e-6, what,
            "its rotation is not a quaternion of length 1");
  }
  void RequireSize(double size_m, const std::string& what, const char* field) {
    Require(size_m > 0.0 && std::isfinite(size_m), what,
            fmt::format("{} is {}, expected more than zero", field, size_m));
  }
  void RequireSurface(const Surface& surface, const std::string& what) {
    const auto is_share = [](double value) { return value >= 0.0 && value <= 1.0; };
    Require(is_share(surface.reflectivity) && is_share(surface.albedo), what,
            fmt::format("its reflectivity is {} and its albedo {}, expected 0 to 1",
                        surface.reflectivity, surface.albedo));
  }

  void CheckCounts() {
    const auto check = [&](const char* what, std::size_t count, std::size_t most) {
      Require(count <= most, what, fmt::format("expected at most {}, got {}", most, count));
    };
    check("boards", scene_.boards.size(), kMaxSceneBoards);
    check("cameras", scene_.cameras.size(), kMaxSceneCameras);
    check("walls", scene_.walls.size(), kMaxSceneShapes);
    check("boxes", scene_.boxes.size(), kMaxSceneShapes);
    check("cylinders", scene_.cylinders.size(), kMaxSceneShapes);
    Require(!scene_.boards.empty(), "boards", "expected at least one board to calibrate with");
    Require(!scene_.cameras.empty(), "cameras", "expected at least one camera");
    Require(scene_.background_albedo >= 0.0 && scene_.background_albedo <= 1.0, "background_albedo",
            "expected 0 to 1");
  }

  void CheckLidar() {
    RequirePose(scene_.lidar.world_from_lidar, "lidar");
    Expected<LidarModel> model = FindLidarModel(scene_.lidar.model);
    if (!model) return Fail(model.error());
    lidar_ = std::move(*model);
  }

  void CheckCamera(const SceneCamera& camera) {
    const std::string what = fmt::format("camera '{}'", camera.name);
    RequirePose(camera.world_from_cam, what);
    Require(IsFileName(camera.name), what,
            fmt::format("its name is used in file names: expected {}", kFileNameRule));
    const auto same = std::count_if(scene_.cameras.begin(), scene_.cameras.end(),
                                    [&](const SceneCamera& c) { return c.name == camera.name; });
    Require(same == 1, what, "another camera has the same name");
    const Expected<Camera> rendering = RenderingCamera(camera);
    if (!rendering) return Fail(rendering.error());
    const Expected<Camera> assumed = PublishedCamera(camera);
    if (!assumed) return Fail(assumed.error());
    Require(assumed->width_px == rendering->width_px && assumed->height_px == rendering->height_px,
            what,
            fmt::format("its image has {} x {} px, assumed_intrinsics state {} x {}",
                        rendering->width_px, rendering->height_px, assumed->width_px,
                        assumed->height_px));
    cameras_.push_back(*rendering);
  }

  void CheckTags(const SceneBoard& board) {
    for (const BoardTag& tag : board.board.tags) {
      const Expected<int> count = TagCount(tag.family);
      if (!count) {
        return Fail({count.error().code, NameOf(board) + ": " + count.error().message});
      }
      Require(tag.id < *count, NameOf(board),
              fmt::format("tag id {} is out of range: {} has the ids 0 to {}", tag.id, tag.family,
                          *count - 1));
    }
  }

  void CheckBoard(const SceneBoard& board) {
    const std::string what = NameOf(board);
    RequirePose(board.world_from_board, what);
    if (const std::optional<BoardFault> fault = FindBoardFault(board.board)) {
      Fail(Invalid(fmt::format("{}: {}{}{}", what, fault->field, fault->field.empty() ? "" : ": ",
                               fault->message)));
    }
    CheckTags(board);
    RequireSurface(board.white, what);
    RequireSurface(board.black, what);
    if (!board.swing) return;
    const Swing& swing = *board.swing;
    Require(swing.axis_in_world.allFinite() && swing.axis_in_world.norm() > 1e-9, what,
            "its swing's axis has no direction");
    Require(std::abs(swing.amplitude_rad) < 1.6 && std::isfinite(swing.phase_rad), what,
            "its swing's amplitude is expected within +-90 degrees");
    RequireSize(swing.period_s, what, "its swing's period_s");
  }

  void CheckShapes() {
    for (std::size_t i = 0; i < scene_.walls.size(); ++i) {
      const SceneWall& wall = scene_.walls[i];
      const std::string what = Named("wall", i, wall.name);
      RequirePose(wall.world_from_wall, what);
      RequireSize(wall.width_m, what, "width_m");
      RequireSize(wall.height_m, what, "height_m");
      RequireSurface(wall.surface, what);
    }
    for (std::size_t i = 0; i < scene_.boxes.size(); ++i) {
      const SceneBox& box = scene_.boxes[i];
      const std::string what = Named("box", i, box.name);
      RequirePose(box.world_from_box, what);
      for (int axis = 0; axis < 3; ++axis) RequireSize(box.size_m[axis], what, "size_m");
      RequireSurface(box.surface, what);
    }
    for (std::size_t i = 0; i < scene_.cylinders.size(); ++i) {
      const SceneCylinder& cylinder = scene_.cylinders[i];
      const std::string what = Named("cylinder", i, cylinder.name);
      Require(cylinder.base_in_world.allFinite(), what, "its base is not finite");
      RequireSize(cylinder.radius_m, what, "radius_m");
      RequireSize(cylinder.height_m, what, "height_m");
      RequireSurface(cylinder.surface, what);
    }
  }

  void CheckIsFree(const std::string& what, const Eigen::Vector3d& at) {
    constexpr double kClosest_m = 0.01;
    for (std::size_t i = 0; i < scene_.boxes.size(); ++i) {
      Require(!IsInside(at, scene_.boxes[i]), what,
              "it is inside " + Named("box", i, scene_.boxes[i].name) + "; move one of them");
    }
    for (std::size_t i = 0; i < scene_.cylinders.size(); ++i) {
      Require(
          !IsInside(at, scene_.cylinders[i]), what,
          "it is inside " + Named("cylinder", i, scene_.cylinders[i].name) + "; move one of them");
    }
    for (std::size_t i = 0; i < scene_.walls.size(); ++i) {
      Require(RectangleOf(scene_.walls[i]).DistanceTo(at) > kClosest_m, what,
              "it is inside " + Named("wall", i, scene_.walls[i].name) + "; move one of them");
    }
    for (const SceneBoard& board : scene_.boards) {
      Require(RectangleOf(board, board.world_from_board).DistanceTo(at) > kClosest_m, what,
              "it is inside " + NameOf(board) + "; move one of them");
    }
  }

  void CheckSensorsAreFree() {
    CheckIsFree("lidar", scene_.lidar.world_from_lidar.translation);
    for (const SceneCamera& camera : scene_.cameras) {
      CheckIsFree(fmt::format("camera '{}'", camera.name), camera.world_from_cam.translation);
    }
  }

  void CheckIsFree(const SceneBoard& board, const SceneRectangle& place) {
    const std::string what = NameOf(board);
    for (std::size_t i = 0; i < scene_.walls.size(); ++i) {
      Require(!Crosses(place, RectangleOf(scene_.walls[i])), what,
              "it intersects " + Named("wall", i, scene_.walls[i].name) + "; move one of them");
    }
    for (std::size_t i = 0; i < scene_.boxes.size(); ++i) {
      Require(!Crosses(place, scene_.boxes[i]), what,
              "it intersects " + Named("box", i, scene_.boxes[i].name) + "; move one of them");
    }
    for (std::size_t i = 0; i < scene_.cylinders.size(); ++i) {
      Require(
          !Crosses(place, scene_.cylinders[i]), what,
          "it intersects " + Named("cylinder", i, scene_.cylinders[i].name) + "; move one of them");
    }
    for (const SceneBoard& other : scene_.boards) {
      if (&other == &board) continue;
      Require(!Crosses(place, RectangleOf(other, other.world_from_board)), what,
              "it intersects " + NameOf(other) + "; move one of them");
    }
  }

  // Positions at rest and at both ends of the swing.
  static std::vector<SceneRectangle> PlacesOf(const SceneBoard& board) {
    if (!board.swing) return {RectangleOf(board, board.world_from_board)};
    SceneBoard still = board;
    still.swing->period_s = 4.0;
    still.swing->phase_rad = 0.0;
    std::vector<SceneRectangle> places;
    for (const double quarter : {0.0, 1.0, 3.0}) {
      places.push_back(RectangleOf(board, BoardPoseAt(still, quarter)));
    }
    return places;
  }

  void CheckBoardsAreFree() {
    for (const SceneBoard& board : scene_.boards) {
      for (const SceneRectangle& place : PlacesOf(board)) CheckIsFree(board, place);
    }
  }

  void CheckBoardsAreSeen() {
    for (const SceneBoard& board : scene_.boards) {
      std::string why;
      for (std::size_t i = 0; i < cameras_.size(); ++i) {
        why = WhyUnseen(board, scene_.cameras[i], cameras_[i]);
        if (why.empty()) break;
      }
      Require(why.empty(), NameOf(board), "no camera sees it: " + why + "; rotate or move it");
      Require(IsReached(board, scene_.lidar.world_from_lidar, lidar_), NameOf(board),
              fmt::format("the LiDAR does not see it: it is outside the angles or the range of {} "
                          "to {} m of {}; move it",
                          lidar_.min_range_m, lidar_.max_range_m, lidar_.name));
    }
  }

  static SceneRectangle RectangleOf(const SceneWall& wall) {
    return {wall.world_from_wall, wall.width_m, wall.height_m};
  }
  static SceneRectangle RectangleOf(const SceneBoard& board, const Rigid3d& world_from_board) {
    return {world_from_board, board.board.top_right_m, board.board.right_bottom_m};
  }

  const Scene& scene_;
  LidarModel lidar_;
  std::vector<Camera> cameras_;
  std::optional<Error> error_;
};

}  // namespace

Expected<void> ValidateScene(const Scene& scene) { return SceneCheck(scene).Run(); }

}  // namespace sextant
