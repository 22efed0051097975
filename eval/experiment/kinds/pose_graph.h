// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/uncertain_pose.h"

namespace sextant {

/// A measured transform between two sensors: cam_from_lidar of one calibration.
struct PoseEdge {
  std::string from{};  ///< Frame a.
  std::string to{};    ///< Frame b.
  UncertainPose to_from{};
};

/// The poses of several sensors, estimated from transforms measured between pairs of them.
class SensorGraph {
 public:
  /// Estimates the poses of all sensors jointly: least squares of the whitened differences
  /// (Log(R_ij R_hat_ij^T), t_ij - t_hat_ij) between measured and implied transforms, on SE(3), by
  /// Gauss-Newton from the shortest chains of edges (Grisetti et al. 2010, "A tutorial on
  /// graph-based SLAM"). Any number of cameras and LiDARs; two sensors may be measured against each
  /// other more than once, and in either direction. Without a loop the result is the chain itself.
  ///
  /// Assumes that the errors of different edges are independent. Errors: kMissingData (no edge);
  /// kInvalidInput (an edge from a frame to itself, a covariance that is not positive definite;
  /// names the edge); kNonFinite; kDegenerate (a sensor that no chain of edges joins to the first
  /// one; names it); kNoConvergence.
  static Expected<SensorGraph> Solve(const std::vector<PoseEdge>& edges);

  /// Names in the order of their first appearance in the edges; the first is the reference.
  const std::vector<std::string>& frames() const { return frames_; }

  /// Transform from frame `from` to frame `to` with its covariance, chained through other sensors
  /// if the two were never measured against each other. Error: kUnknownName, with the nearest known
  /// name.
  Expected<UncertainPose> Between(std::string_view to, std::string_view from) const;

  /// Sum of squared whitened residuals: chi-square distributed with `redundancy()` degrees of
  /// freedom if the covariances are right.
  double chi_square() const { return chi_square_; }
  int redundancy() const { return redundancy_; }  ///< 6 per loop; 0: no redundant measurements.

 private:
  SensorGraph() = default;
  Expected<std::size_t> Find(std::string_view name) const;

  std::vector<std::string> frames_;
  std::vector<Rigid3d> frame_from_reference_;
  Eigen::MatrixXd covariance_;  // Joint covariance of all frames except the reference, the first.
  double chi_square_ = 0.0;
  int redundancy_ = 0;
};

}  // namespace sextant
