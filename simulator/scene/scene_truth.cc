// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/scene_truth.h"

#include <array>

#include "geometry/board_check.h"
#include "simulator/scene/camera_model.h"

namespace sextant {
namespace {

std::array<Eigen::Vector2d, 4> Rectangle(const Eigen::Vector2d& center, double width,
                                         double height) {
  const Eigen::Vector2d right(0.5 * width, 0.0);
  const Eigen::Vector2d down(0.0, 0.5 * height);
  return {center - right - down, center + right - down, center + right + down,
          center - right + down};
}

class Observer {
 public:
  explicit Observer(const Scene& scene)
      : lidar_from_world_(scene.lidar.world_from_lidar.Inverse()) {
    for (const SceneCamera& camera : scene.cameras) {
      cameras_.push_back({camera.world_from_cam.Inverse(), *RenderingCamera(camera)});
    }
  }

  CornerTruth See(const Eigen::Vector3d& in_world) const {
    CornerTruth corner;
    corner.in_world = in_world;
    corner.in_lidar = lidar_from_world_ * in_world;
    for (const View& view : cameras_) {
      const Eigen::Vector3d in_cam = view.cam_from_world * in_world;
      corner.in_cam.push_back(in_cam);
      corner.pixel.push_back(InImage(view.camera, in_cam));
    }
    return corner;
  }

  std::vector<CornerTruth> See(const Rigid3d& world_from_board,
                               const std::array<Eigen::Vector2d, 4>& in_board) const {
    std::vector<CornerTruth> corners;
    for (const Eigen::Vector2d& p : in_board) {
      corners.push_back(See(world_from_board * Eigen::Vector3d(p.x(), p.y(), 0.0)));
    }
    return corners;
  }

 private:
  struct View {
    Rigid3d cam_from_world;
    Camera camera;
  };

  static std::optional<Eigen::Vector2d> InImage(const Camera& camera,
                                                const Eigen::Vector3d& in_cam) {
    const std::optional<Eigen::Vector2d> pixel = Project(camera, in_cam);
    const bool is_inside = pixel && pixel->x() >= -0.5 && pixel->x() <= camera.width_px - 0.5 &&
                           pixel->y() >= -0.5 && pixel->y() <= camera.height_px - 0.5;
    return is_inside ? pixel : std::nullopt;
  }

  Rigid3d lidar_from_world_;
  std::vector<View> cameras_;
};

}  // namespace

std::vector<BoardTruth> BoardsAt(const Scene& scene, double time_s) {
  const Observer observer(scene);
  std::vector<BoardTruth> truths;
  for (const SceneBoard& scene_board : scene.boards) {
    const Board& board = scene_board.board;
    BoardTruth truth{.id = board.id, .world_from_board = BoardPoseAt(scene_board, time_s)};
    truth.corners =
        observer.See(truth.world_from_board,
                     Rectangle(Eigen::Vector2d::Zero(), board.top_right_m, board.right_bottom_m));
    if (board.hole) {
      const std::vector<CornerTruth> inner = observer.See(
          truth.world_from_board,
          Rectangle(board.hole->center_in_board_m, board.hole->width_m, board.hole->height_m));
      truth.corners.insert(truth.corners.end(), inner.begin(), inner.end());
    }
    for (const BoardTag& tag : board.tags) {
      truth.tags.push_back(
          {tag.family, tag.id, observer.See(truth.world_from_board, TagCorners(tag))});
    }
    truths.push_back(std::move(truth));
  }
  return truths;
}

Rigid3d CamFromLidar(const Scene& scene, const SceneCamera& camera) {
  return camera.world_from_cam.Inverse() * scene.lidar.world_from_lidar;
}

}  // namespace sextant
