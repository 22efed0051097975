// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/kinds/stereo_scene.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "base/random.h"
#include "features/camera/tag_detector.h"
#include "geometry/symmetric.h"
#include "simulator/session/stereo_cloud.h"
#include "solvers/kernels/cloud_sums.h"

namespace sextant {
namespace {

constexpr double kBaseline_m = 0.12;
constexpr std::size_t kEnoughPoints = 500;  // Minimum per wall in each cloud.
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Corners of the checkerboard triangulated from both images of a stereo camera; empty if one image
// does not show it.
Expected<std::vector<Eigen::Vector3d>> CheckerCorners(const Scene& scene,
                                                      const StereoImages& images) {
  std::vector<Eigen::Vector3d> corners;
  for (const SceneBoard& board : scene.boards) {
    if (!board.board.checker) continue;
    SEXTANT_ASSIGN_OR_RETURN(const auto detector,
                             MakeTagDetector(fmt::format("checkerboard(columns={},rows={})",
                                                         board.board.checker->inner_columns,
                                                         board.board.checker->inner_rows)));
    const Expected<Detections> left = detector->Detect(images.left);
    const Expected<Detections> right = detector->Detect(images.right);
    if (!left || !right || left->checkers.empty() || right->checkers.empty()) continue;
    const std::vector<Eigen::Vector2d>& in_left = left->checkers[0].corners_px;
    const std::vector<Eigen::Vector2d>& in_right = right->checkers[0].corners_px;
    for (std::size_t i = 0; i < in_left.size() && i < in_right.size(); ++i) {
      const auto corner = Triangulate(images, in_left[i], in_right[i]);
      if (corner) corners.push_back(*corner);
    }
  }
  return corners;
}

// Whether the point lies on the wall within the accuracy of the stereo depth at that distance.
bool IsOn(const SceneWall& wall, const Rigid3d& wall_from_cam, const Eigen::Vector3d& point) {
  constexpr double kMargin_m = 0.05;
  const double depth_error_m = 0.01 + 0.01 * point.z() * point.z();
  const Eigen::Vector3d in_wall = wall_from_cam * point;
  return std::abs(in_wall.z()) < depth_error_m &&
         std::abs(in_wall.x()) < 0.5 * wall.width_m - kMargin_m &&
         std::abs(in_wall.y()) < 0.5 * wall.height_m - kMargin_m;
}

}  // namespace

Expected<StereoPair> RenderStereoPair(const Scene& full_scene) {
  Scene scene = full_scene;
  std::erase_if(scene.boards, [](const SceneBoard& board) { return !board.board.checker; });
  StereoPair pair;
  pair.walls.resize(scene.walls.size());
  for (std::size_t i = 0; i < 2; ++i) {
    SEXTANT_ASSIGN_OR_RETURN(const StereoImages images,
                             RenderStereo(scene, static_cast<int>(i), kBaseline_m,
                                          UsualImageOptions(DeriveSeed(1, "stereo", i, 0), 0.0)));
    SEXTANT_ASSIGN_OR_RETURN(PointCloud cloud, MatchStereo(images, {}));
    pair.clouds[i] = std::move(cloud);
    SEXTANT_ASSIGN_OR_RETURN(std::vector<Eigen::Vector3d> checker, CheckerCorners(scene, images));
    pair.checker[i] = std::move(checker);
    for (std::size_t w = 0; w < scene.walls.size(); ++w) {
      const SceneWall& wall = scene.walls[w];
      const Rigid3d wall_from_cam =
          wall.world_from_wall.Inverse() * scene.cameras[i].world_from_cam;
      for (const Eigen::Vector3d& point : pair.clouds[i].points) {
        if (IsOn(wall, wall_from_cam, point)) pair.walls[w][i].push_back(point);
      }
    }
  }
  std::erase_if(pair.walls, [](const auto& wall) {
    return wall[0].size() < kEnoughPoints || wall[1].size() < kEnoughPoints;
  });
  // Cameras on opposite sides count the corners from opposite ends, so only the means are compared;
  // for these the number of corners must agree.
  if (pair.checker[0].size() != pair.checker[1].size()) pair.checker = {};
  return pair;
}

double WallOffset(const StereoPair& pair, const Rigid3d& cam2_from_cam1) {
  double squares = 0.0;
  for (const auto& [first, second] : pair.walls) {
    const Eigen::Vector3d middle = MeanOf(second);
    const SymmetricEigen<3> eigen = EigenOf(ScatterAbout(middle, second));
    double mean = 0.0;
    for (const Eigen::Vector3d& point : first) {
      mean += eigen.vectors.col(0).dot(cam2_from_cam1 * point - middle);
    }
    mean /= static_cast<double>(first.size());
    squares += mean * mean;
  }
  return pair.walls.empty() ? kNan : std::sqrt(squares / static_cast<double>(pair.walls.size()));
}

double CheckerOffset(const StereoPair& pair, const Rigid3d& cam2_from_cam1) {
  if (pair.checker[0].empty()) return kNan;
  return (cam2_from_cam1 * MeanOf(pair.checker[0]) - MeanOf(pair.checker[1])).norm();
}

}  // namespace sextant
