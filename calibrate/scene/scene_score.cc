// SPDX-License-Identifier: Apache-2.0
#include "calibrate/scene/scene_score.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/units.h"
#include "geometry/intrinsics.h"

namespace sextant {
namespace {

constexpr double kFocal_px = 720.0;   // Larger images are reduced to this resolution.
constexpr double kMinSide_px = 16.0;  // The fields halve the reduced image three times.
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

// A model with the rotation as a matrix.
struct EdgeProjector {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  double focal_factor;
  Eigen::Vector2d centre_moved;

  explicit EdgeProjector(const SceneModel& model)
      : rotation(model.cam_from_lidar.rotation.toRotationMatrix()),
        translation(model.cam_from_lidar.translation),
        focal_factor(std::exp(model.intrinsics(0))),
        centre_moved(model.intrinsics.tail<2>()) {}
};

EdgeScore ScoreEdge(const ScenePair& pair, int level, const EdgeProjector& model,
                    const ScanEdge& edge) {
  EdgeScore result;
  const Eigen::Vector3d turned = model.rotation * edge.point;
  const Eigen::Vector3d in_cam = turned + model.translation;
  if (in_cam.norm() < kMinDepth_m) return result;
  const auto projected = ProjectWithJacobian(pair.camera, in_cam);
  if (!projected) return result;
  const double focal_px = pair.camera.fx_px;
  const Eigen::Vector2d centre(pair.camera.cx_px, pair.camera.cy_px);
  const Eigen::Vector2d from_centre = model.focal_factor * (projected->pixel - centre);
  const Eigen::Vector2d pixel = centre + from_centre + focal_px * model.centre_moved;
  const Eigen::Vector2d normal = projected->pixel_by_point * (model.rotation * edge.across);
  const auto field = pair.fields.At(level, pixel, normal);
  if (!field) return result;
  result.pixel = pixel;
  const double weight = WeightOf(edge, level, focal_px, pair.fields.SigmaPx(level)) /
                        std::sqrt(static_cast<double>(pair.edges.size()));
  const Eigen::Vector2d by_pixel = weight * field->gradient;
  const Eigen::Vector3d by_point =
      model.focal_factor * (projected->pixel_by_point.transpose() * by_pixel);
  result.score.value = weight * field->value;
  result.score.gradient << turned.cross(by_point), by_point, by_pixel.dot(from_centre),
      focal_px * by_pixel;
  return result;
}

// -1 outside of the image.
int ColumnOf(const Camera& camera, const Eigen::Vector2d& pixel) {
  if (pixel.x() < 0.0) return -1;
  return std::clamp(static_cast<int>(kColumns * pixel.x() / camera.width_px), 0, kColumns - 1);
}

}  // namespace

Expected<ScenePair> MakeScenePair(const cv::Mat& grey, const PointCloud& scan, Camera camera,
                                  const Rigid3d& cam_from_lidar) {
  camera = WithImageSize(camera, grey.cols, grey.rows);
  SEXTANT_RETURN_IF_ERROR(ValidateCamera(camera));
  const double scale = std::min(1.0, kFocal_px / camera.fx_px);
  if (scale * std::min(grey.cols, grey.rows) < kMinSide_px) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("an image of {} x {} pixels shows too little of a scene where fx is "
                    "{:.6g} px; does the camera file belong to it?",
                    grey.cols, grey.rows, camera.fx_px));
  }
  SEXTANT_ASSIGN_OR_RETURN(std::vector<ScanEdge> edges, FindScanEdges(scan));
  std::erase_if(
      edges, [&](const ScanEdge& edge) { return !MayBeSeen(camera, cam_from_lidar * edge.point); });
  return ScenePair{.camera = camera,
                   .edges = std::move(edges),
                   .fields = EdgeFields(grey, scale),
                   .thumbnail = ThumbnailOf(grey)};
}

SceneModel Perturb(const SceneModel& model, const Vector9d& delta) {
  return {.cam_from_lidar = Perturb(model.cam_from_lidar, Vector6d(delta.head<6>())),
          .intrinsics = model.intrinsics + delta.tail<3>()};
}

SceneScore ScoreScenes(std::span<const ScenePair> pairs, int level, const SceneModel& model,
                       std::size_t stride) {
  const EdgeProjector projector(model);
  std::vector<SceneScore> scores(pairs.size());
  tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
    const std::vector<ScanEdge>& edges = pairs[i].edges;
    for (std::size_t k = 0; k < edges.size(); k += stride) {
      scores[i] += ScoreEdge(pairs[i], level, projector, edges[k]).score;
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
                                   const SceneModel& model) {
  const EdgeProjector projector(model);
  std::vector<SceneScore> tiles(pairs.size() * kColumns * kRows);
  const std::vector<std::size_t> scenes = SceneOf(pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Camera& camera = pairs[i].camera;
    for (const ScanEdge& edge : pairs[i].edges) {
      const EdgeScore one = ScoreEdge(pairs[i], level, projector, edge);
      const int column = ColumnOf(camera, one.pixel);
      if (column < 0) continue;
      const int row =
          std::clamp(static_cast<int>(kRows * one.pixel.y() / camera.height_px), 0, kRows - 1);
      tiles[scenes[i] * kColumns * kRows + static_cast<std::size_t>(row * kColumns + column)] +=
          one.score;
    }
  }
  return tiles;
}

std::array<std::vector<ScenePair>, 2> HalvesOf(std::span<const ScenePair> pairs,
                                               const Rigid3d& cam_from_lidar) {
  std::array<std::vector<ScenePair>, 2> halves;
  const std::vector<std::size_t> scenes = SceneOf(pairs);
  std::vector<std::size_t> half_of(pairs.size(), 0);
  std::size_t count = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    half_of[i] = scenes[i] == i ? count++ % 2 : half_of[scenes[i]];
  }
  if (count > 1) {
    for (std::size_t i = 0; i < pairs.size(); ++i) halves[half_of[i]].push_back(pairs[i]);
    return halves;
  }
  for (std::size_t half = 0; half < 2; ++half) {
    for (const ScenePair& pair : pairs) {
      ScenePair& kept = halves[half].emplace_back(pair);
      std::erase_if(kept.edges, [&](const ScanEdge& edge) {
        const auto pixel = Project(pair.camera, cam_from_lidar * edge.point);
        return !pixel || ColumnOf(pair.camera, *pixel) % 2 != static_cast<int>(half);
      });
    }
  }
  return halves;
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
