// SPDX-License-Identifier: Apache-2.0
#include "solvers/icp/point_to_plane.h"

#include <fmt/core.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "geometry/symmetric.h"

namespace sextant {
namespace {

// Ratio of the second to the first principal variance below which neighbours lie on a line.
constexpr double kMinRelativeSpread = 1e-10;

// For the normalised Hessian, whose eigenvalues are of the order of one: that of an undetermined
// motion is 1e-16 by rounding, while one percent of curvature or tilt gives 1e-4.
constexpr double kMinEigenvalue = 1e-10;

double DistanceToPlane(const PlaneMatch& match, const Rigid3d& b_from_a) {
  return match.normal_in_b.dot(b_from_a * match.point_in_a - match.plane_point_in_b);
}

}  // namespace

SurfaceNormals::SurfaceNormals(std::span<const Eigen::Vector3d> points, const PointTree& tree,
                               int neighbours)
    : points_(points),
      tree_(tree),
      nearest_(static_cast<std::size_t>(neighbours)),
      squared_distances_(nearest_.size()),
      normals_(points.size()),
      known_(points.size(), false) {}

const Eigen::Vector3d& SurfaceNormals::operator[](std::size_t i) {
  if (!known_[i]) {
    normals_[i] = Compute(points_[i]);
    known_[i] = true;
  }
  return normals_[i];
}

Eigen::Vector3d SurfaceNormals::Compute(const Eigen::Vector3d& point) {
  const std::size_t count = tree_.NearestFew(point, nearest_, squared_distances_);
  const std::span<const unsigned> found = std::span(nearest_).first(count);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const unsigned j : found) mean += points_[j] - point;
  mean /= static_cast<double>(count);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const unsigned j : found) {
    const Eigen::Vector3d d = points_[j] - point - mean;
    spread += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(spread);
  const Eigen::Vector3d& lambda = eigen.eigenvalues();
  if (!(lambda(1) > kMinRelativeSpread * lambda(2))) return Eigen::Vector3d::Zero();
  return eigen.eigenvectors().col(0);
}

Expected<Rigid3d> StepToPlanes(std::span<const PlaneMatch> matches, const Rigid3d& b_from_a) {
  if (matches.size() < 6) {
    return MakeError(
        ErrorCode::kTooFewPairs,
        fmt::format("point to plane needs at least 6 matches, got {}", matches.size()));
  }
  const double n = static_cast<double>(matches.size());
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const PlaneMatch& match : matches) centre += b_from_a * match.point_in_a;
  centre /= n;
  double squares = 0.0;
  for (const PlaneMatch& match : matches) {
    squares += (b_from_a * match.point_in_a - centre).squaredNorm();
  }
  const double size = std::sqrt(squares / n);

  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  for (const PlaneMatch& match : matches) {
    const Eigen::Vector3d arm = (b_from_a * match.point_in_a - centre) / size;
    Vector6d row;
    row << arm.cross(match.normal_in_b), match.normal_in_b;
    hessian += row * row.transpose() / n;
    gradient += row * (DistanceToPlane(match, b_from_a) / n);
  }
  const SymmetricEigen<6> solved = EigenOf(hessian);
  if (!(solved.values(0) > kMinEigenvalue)) {
    return MakeError(ErrorCode::kDegenerate,
                     "the planes leave a motion undetermined: one plane alone, parallel planes or "
                     "a sphere do; use metric=point or add surfaces of other directions");
  }
  const Vector6d step =
      -(solved.vectors * (solved.vectors.transpose() * gradient).cwiseQuotient(solved.values));
  const Eigen::Quaterniond turn = ExpSo3(step.head<3>() / size);
  return Rigid3d{(turn * b_from_a.rotation).normalized(),
                 turn * (b_from_a.translation - centre) + centre + step.tail<3>()};
}

double RmseToPlanes(std::span<const PlaneMatch> matches, const Rigid3d& b_from_a) {
  double squares = 0.0;
  for (const PlaneMatch& match : matches) squares += std::pow(DistanceToPlane(match, b_from_a), 2);
  return std::sqrt(squares / static_cast<double>(matches.size()));
}

std::optional<Matrix6d> PlaneCovariance(std::span<const PlaneMatch> matches,
                                        const Rigid3d& b_from_a) {
  if (matches.size() <= 6) return std::nullopt;
  Matrix6d hessian = Matrix6d::Zero();
  for (const PlaneMatch& match : matches) {
    Vector6d row;
    row << (b_from_a.rotation * match.point_in_a).cross(match.normal_in_b), match.normal_in_b;
    hessian += row * row.transpose();
  }
  const std::optional<Matrix6d> inverse = InvertSymmetric(hessian);
  if (!inverse) return std::nullopt;
  const double n = static_cast<double>(matches.size());
  const double rmse = RmseToPlanes(matches, b_from_a);
  return Matrix6d(*inverse * (rmse * rmse * n / (n - 6.0)));
}

}  // namespace sextant
