// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/cloud_fusion.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "base/median.h"
#include "solvers/icp/point_tree.h"

namespace sextant {
namespace {

std::vector<Eigen::Vector3d> FinitePoints(const PointCloud& cloud) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(cloud.points.size());
  for (const Eigen::Vector3d& point : cloud.points) {
    if (point.allFinite()) points.push_back(point);
  }
  return points;
}

// Distance of `query` from the plane through some points, along its normal; none if the points are
// not flat.
std::optional<double> DistanceToPatch(const std::vector<Eigen::Vector3d>& points,
                                      std::span<const unsigned> indices,
                                      const Eigen::Vector3d& query, double flatness) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const unsigned i : indices) mean += points[i];
  mean /= static_cast<double>(indices.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const unsigned i : indices) {
    scatter += (points[i] - mean) * (points[i] - mean).transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(scatter);
  // Compared with the second extent, as points along a line define no plane.
  const Eigen::Vector3d extent = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  if (!(extent[0] <= flatness * extent[1])) return std::nullopt;
  return std::abs(eigen.eigenvectors().col(0).dot(query - mean));
}

}  // namespace

PointCloud FuseClouds(std::span<const PointCloud> clouds,
                      std::span<const Rigid3d> target_from_cloud) {
  assert(clouds.size() == target_from_cloud.size());
  const bool has_intensity = std::ranges::all_of(clouds, [](const PointCloud& cloud) {
    return cloud.intensity.size() == cloud.points.size();
  });
  PointCloud fused;
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    for (std::size_t k = 0; k < clouds[i].points.size(); ++k) {
      if (!clouds[i].points[k].allFinite()) continue;
      fused.points.push_back(target_from_cloud[i] * clouds[i].points[k]);
      if (has_intensity) fused.intensity.push_back(clouds[i].intensity[k]);
    }
  }
  return fused;
}

ReferenceCloud::ReferenceCloud(const PointCloud& cloud)
    : points_(FinitePoints(cloud)), tree_(std::make_unique<const PointTree>(points_)) {}
// A moved vector keeps its points where they are, which the tree refers to.
ReferenceCloud::ReferenceCloud(ReferenceCloud&& other) noexcept = default;
ReferenceCloud& ReferenceCloud::operator=(ReferenceCloud&& other) noexcept = default;
ReferenceCloud::~ReferenceCloud() = default;

CloudAgreement CompareClouds(const PointCloud& a, const Rigid3d& b_from_a, const ReferenceCloud& b,
                             const AgreementOptions& options) {
  const std::vector<Eigen::Vector3d> queries = FinitePoints(a);
  CloudAgreement agreement{.median_m = std::numeric_limits<double>::quiet_NaN(),
                           .rms_m = std::numeric_limits<double>::quiet_NaN()};
  const std::size_t step =
      std::max<std::size_t>(1, queries.size() / static_cast<std::size_t>(options.max_points));
  const auto few = static_cast<std::size_t>(options.neighbours);
  std::vector<unsigned> indices(few);
  std::vector<double> squared(few);
  std::vector<double> distances;
  for (std::size_t i = 0; i < queries.size(); i += step) {
    ++agreement.points;
    const Eigen::Vector3d query = b_from_a * queries[i];
    const std::size_t found = b.tree().NearestFew(query, indices, squared);
    if (found < few || squared[0] > options.reach_m * options.reach_m) continue;
    const auto distance = DistanceToPatch(b.points(), indices, query, options.flatness);
    if (distance) distances.push_back(*distance);
  }
  agreement.compared = static_cast<int>(distances.size());
  if (distances.empty()) return agreement;
  double squares = 0.0;
  for (const double distance : distances) squares += distance * distance;
  agreement.rms_m = std::sqrt(squares / static_cast<double>(distances.size()));
  agreement.median_m = UpperMedian(distances);
  return agreement;
}

}  // namespace sextant
