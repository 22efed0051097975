// SPDX-License-Identifier: Apache-2.0
#include "calibrate/scene/scene_score.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/units.h"

namespace sextant {
namespace {

constexpr double kFocal_px = 720.0;  // Larger images are reduced to this resolution.
constexpr double kMargin_rad = 4.0 * kRadPerDeg;
constexpr double kMinDepth_m = 0.3;
// Between sweeps a beam that grazes an edge still returns the nearer surface, which moves the edge
// outwards by a part of the gap: they guide the search and hardly count at the finest level.
constexpr double kBetweenWeight = 0.5;
constexpr double kBetweenWeightFinest = 0.05;
constexpr int kColumns = 6;
constexpr int kRows = 2;

bool MayBeSeen(const Camera& camera, const Eigen::Vector3d& point_in_cam) {
  const auto pixel = Project(camera, point_in_cam);
  if (!pixel) return false;
  const double margin = kMargin_rad * camera.fx_px;
  return pixel->x() > -margin && pixel->x() < camera.width_px + margin && pixel->y() > -margin &&
         pixel->y() < camera.height_px + margin;
}

double WeightOf(const ScanEdge& edge, int level, double focal_px, double blur_px) {
  const double spread = edge.gap_rad * focal_px / std::sqrt(12.0) / blur_px;
  const double between = level == 0 ? kBetweenWeightFinest : kBetweenWeight;
  return (edge.is_between_sweeps ? between : 1.0) / (1.0 + spread * spread);
}

cv::Mat ThumbnailOf(const cv::Mat& grey) {
  cv::Mat small;
  cv::resize(grey, small, {32, 20}, 0.0, 0.0, cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  small -= cv::mean(small)[0];
  const double length = cv::norm(small);
  if (length > 0.0) small /= length;
  return small;
}

// For each pair the first one that shows the same scene.
std::vector<std::size_t> SceneOf(std::span<const ScenePair> pairs) {
  constexpr double kAlike = 0.85;
  std::vector<std::size_t> scenes;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    std::size_t scene = i;
    for (std::size_t j = 0; j < i && scene == i; ++j) {
      if (pairs[i].thumbnail.dot(pairs[j].thumbnail) > kAlike) scene = scenes[j];
    }
    scenes.push_back(scene);
  }
  return scenes;
}

struct EdgeScore {
  SceneScore score;
  Eigen::Vector2d pixel = Eigen::Vector2d::Constant(-1.0);
};

EdgeScore ScoreEdge(const ScenePair& pair, int level, const Eigen::Matrix3d& rotation,
                    const Eigen::Vector3d& translation, const ScanEdge& edge) {
  EdgeScore result;
  const Eigen::Vector3d turned = rotation * edge.point;
  const Eigen::Vector3d in_cam = turned + translation;
  if (in_cam.norm() < kMinDepth_m) return result;
  const auto projected = ProjectWithJacobian(pair.camera, in_cam);
  if (!projected) return result;
  const Eigen::Vector2d normal = projected->pixel_by_point * (rotation * edge.across);
  const auto field = pair.fields.At(level, projected->pixel, normal);
  if (!field) return result;
  result.pixel = projected->pixel;
  const double weight = WeightOf(edge, level, pair.camera.fx_px, pair.fields.Sigma_px(level)) /
                        std::sqrt(static_cast<double>(pair.edges.size()));
  const Eigen::Vector3d by_point =
      weight * (projected->pixel_by_point.transpose() * field->gradient);
  result.score.value = weight * field->value;
  result.score.gradient << turned.cross(by_point), by_point;
  return result;
}

}  // namespace

Expected<ScenePair> MakeScenePair(const cv::Mat& grey, const PointCloud& scan, Camera camera,
                                  const Rigid3d& cam_from_lidar) {
  camera.width_px = grey.cols;
  camera.height_px = grey.rows;
  SEXTANT_ASSIGN_OR_RETURN(std::vector<ScanEdge> edges, FindScanEdges(scan));
  std::erase_if(
      edges, [&](const ScanEdge& edge) { return !MayBeSeen(camera, cam_from_lidar * edge.point); });
  return ScenePair{.camera = camera,
                   .edges = std::move(edges),
                   .fields = EdgeFields(grey, std::min(1.0, kFocal_px / camera.fx_px)),
                   .thumbnail = ThumbnailOf(grey)};
}

SceneScore ScoreScenes(std::span<const ScenePair> pairs, int level, const Rigid3d& cam_from_lidar,
                       std::size_t stride) {
  const Eigen::Matrix3d rotation = cam_from_lidar.rotation.toRotationMatrix();
  std::vector<SceneScore> scores(pairs.size());
  tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
    const std::vector<ScanEdge>& edges = pairs[i].edges;
    for (std::size_t k = 0; k < edges.size(); k += stride) {
      scores[i] += ScoreEdge(pairs[i], level, rotation, cam_from_lidar.translation, edges[k]).score;
    }
  });
  SceneScore sum;
  for (const SceneScore& score : scores) sum += score;
  sum.value *= static_cast<double>(stride);
  sum.gradient *= static_cast<double>(stride);
  return sum;
}

int DistinctScenes(std::span<const ScenePair> pairs) {
  const std::vector<std::size_t> scenes = SceneOf(pairs);
  int count = 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) count += scenes[i] == i;
  return count;
}

std::vector<SceneScore> ScoreTiles(std::span<const ScenePair> pairs, int level,
                                   const Rigid3d& cam_from_lidar) {
  const Eigen::Matrix3d rotation = cam_from_lidar.rotation.toRotationMatrix();
  std::vector<SceneScore> tiles(pairs.size() * kColumns * kRows);
  const std::vector<std::size_t> scenes = SceneOf(pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Camera& camera = pairs[i].camera;
    for (const ScanEdge& edge : pairs[i].edges) {
      const EdgeScore one = ScoreEdge(pairs[i], level, rotation, cam_from_lidar.translation, edge);
      if (one.pixel.x() < 0.0) continue;
      const int column =
          std::clamp(static_cast<int>(kColumns * one.pixel.x() / camera.width_px), 0, kColumns - 1);
      const int row =
          std::clamp(static_cast<int>(kRows * one.pixel.y() / camera.height_px), 0, kRows - 1);
      tiles[scenes[i] * kColumns * kRows + static_cast<std::size_t>(row * kColumns + column)] +=
          one.score;
    }
  }
  return tiles;
}

int EdgesInView(std::span<const ScenePair> pairs, const Rigid3d& cam_from_lidar) {
  int count = 0;
  for (const ScenePair& pair : pairs) {
    for (const ScanEdge& edge : pair.edges) {
      const auto pixel = Project(pair.camera, cam_from_lidar * edge.point);
      count += pixel && pixel->x() >= 0.0 && pixel->y() >= 0.0 &&
               pixel->x() < pair.camera.width_px && pixel->y() < pair.camera.height_px;
    }
  }
  return count;
}

}  // namespace sextant
