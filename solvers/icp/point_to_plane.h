// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"
#include "solvers/icp/point_tree.h"

namespace sextant {

/// Unit normals of a point set, each computed on first access: the direction of smallest variance
/// of the point's nearest neighbours (itself included). The sign is arbitrary.
class SurfaceNormals {
 public:
  /// Points and tree must outlive this. Requires 3 <= neighbours <= points.size().
  SurfaceNormals(std::span<const Eigen::Vector3d> points, const PointTree& tree, int neighbours);

  /// Zero where the neighbours lie on a line or coincide, which leaves the normal undetermined.
  const Eigen::Vector3d& operator[](std::size_t i);

 private:
  Eigen::Vector3d Compute(const Eigen::Vector3d& point);

  std::span<const Eigen::Vector3d> points_;
  const PointTree& tree_;
  std::vector<unsigned> nearest_;
  std::vector<double> squared_distances_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<bool> known_;
};

/// A point of the moving set and its matched plane.
struct PlaneMatch {
  Eigen::Vector3d point_in_a;        ///< Metres.
  Eigen::Vector3d plane_point_in_b;  ///< Metres.
  Eigen::Vector3d normal_in_b;       ///< Unit.
};

/// One Gauss-Newton step from `b_from_a` on sum_i (n_i^T (R a_i + t - p_i))^2, linear in the
/// rotation about the centre of the points (Chen and Medioni 1992; Low 2004). Errors: kTooFewPairs
/// (under 6); kDegenerate: the planes leave a motion undetermined, as one plane alone, parallel
/// planes, or a sphere do.
Expected<Rigid3d> StepToPlanes(std::span<const PlaneMatch> matches, const Rigid3d& b_from_a);

/// sqrt(mean_i (n_i^T (R a_i + t - p_i))^2) [m]. Requires matches.
double RmseToPlanes(std::span<const PlaneMatch> matches, const Rigid3d& b_from_a);

/// s^2 (J^T J)^-1 of (dphi, dt), with s^2 = sum r^2 / (n - 6); none for n <= 6 or a singular J.
std::optional<Matrix6d> PlaneCovariance(std::span<const PlaneMatch> matches,
                                        const Rigid3d& b_from_a);

}  // namespace sextant
