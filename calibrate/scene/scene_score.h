// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "base/error.h"
#include "features/scene/edge_fields.h"
#include "features/scene/scan_edges.h"
#include "geometry/camera.h"
#include "geometry/point_cloud.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The depth edges of a scan that the camera may see, and the edges of its image.
struct ScenePair {
  Camera camera;  ///< With the size of the image.
  std::vector<ScanEdge> edges;
  EdgeFields fields;
  cv::Mat
      thumbnail;  ///< 32 x 20 pixels, of mean 0 and length 1; shows whether two views are alike.
};

/// `grey`: 8 bits. Keeps the edges within 4 degrees of the view of `cam_from_lidar`.
/// Errors: those of FindScanEdges and ValidateCamera; kInvalidInput if the image shows hardly more
/// than one degree by its camera. Time: 0.5 s for an image of two megapixels and a scan of 120k
/// points.
Expected<ScenePair> MakeScenePair(const cv::Mat& grey, const PointCloud& scan, Camera camera,
                                  const Rigid3d& cam_from_lidar);

using Vector9d = Eigen::Matrix<double, 9, 1>;

/// A pose, and by how much the stated intrinsics are off.
struct SceneModel {
  Rigid3d cam_from_lidar;
  /// (s, x, y): the focal lengths are exp(s) times the stated ones, and the principal point is
  /// moved by x and y stated focal lengths to the right and down.
  Eigen::Vector3d intrinsics = Eigen::Vector3d::Zero();
};

/// The model perturbed by (dphi [rad], dt [m], dintrinsics).
SceneModel Perturb(const SceneModel& model, const Vector9d& delta);

/// How well the edges coincide, and its derivative by the perturbation of the model.
struct SceneScore {
  double value = 0.0;
  Vector9d gradient = Vector9d::Zero();

  SceneScore& operator+=(const SceneScore& other) {
    value += other.value;
    gradient += other.gradient;
    return *this;
  }
};

/// The sum over the pairs of sum_i w_i F(u_i) / sqrt(n): u_i is the pixel of edge i, F the field of
/// `level` for its direction (EdgeFields), n the number of edges of the pair, and w_i the smaller,
/// the wider the gap between the two beams is compared with the blur. An edge outside of the image
/// counts 0. `stride`: only every so many edges are used. The same bits on any number of threads.
/// Time: about 0.2 us for each edge.
SceneScore ScoreScenes(std::span<const ScenePair> pairs, int level, const SceneModel& model,
                       std::size_t stride = 1);

/// The same, separately for 6 x 2 tiles of the images. Pairs of the same scene, as a sensor at rest
/// records them, share their tiles: their errors are the same and do not average out.
std::vector<SceneScore> ScoreTiles(std::span<const ScenePair> pairs, int level,
                                   const SceneModel& model);

/// Two halves that share no scene; where all pairs show one scene, its edges left and right of each
/// other in turns, in six columns of the images.
std::array<std::vector<ScenePair>, 2> HalvesOf(std::span<const ScenePair> pairs,
                                               const Rigid3d& cam_from_lidar);

/// The number of scenes that differ, by their thumbnails.
int DistinctScenes(std::span<const ScenePair> pairs);

/// The number of edges in the images.
int EdgesInView(std::span<const ScenePair> pairs, const Rigid3d& cam_from_lidar);

}  // namespace sextant
