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

/// Where every sensor is, by all that was measured between them.
class SensorGraph {
 public:
  /// The poses of all sensors at once: least squares of the whitened differences
  /// (Log(R_ij R_hat_ij^T), t_ij - t_hat_ij) between measured and implied transforms, on SE(3), by
  /// Gauss-Newton from the chain of fewest edges (Grisetti et al. 2010, "A tutorial on graph-based
  /// SLAM"). Any number of cameras and LiDARs; two sensors may be measured against each other more
  /// than once, and in either direction. Without a loop the answer is the chain itself.
  ///
  /// Edges are taken to be independent of each other.
  /// Errors: kMissingData (no edge); kInvalidInput (an edge from a frame to itself, a covariance
  /// that is not positive definite; names the edge); kNonFinite; kDegenerate (a sensor that no
  /// chain of edges joins to the first one; names it); kNoConvergence.
  static Expected<SensorGraph> Solve(const std::vector<PoseEdge>& edges);

  /// Names in the order in which the edges name them; the first is the reference.
  const std::vector<std::string>& frames() const { return frames_; }

  /// to_from_from of any two sensors with its covariance; chained through others where they were
  /// never measured against each other. Error: kUnknownName, with the nearest known.
  Expected<UncertainPose> Between(std::string_view to, std::string_view from) const;

  /// Sum of squared whitened residuals: chi-square of `redundancy()` degrees of freedom where the
  /// covariances are right.
  double chi_square() const { return chi_square_; }
  int redundancy() const { return redundancy_; }  ///< 6 a loop; 0: nothing contradicts.

 private:
  SensorGraph() = default;
  Expected<std::size_t> Find(std::string_view name) const;

  std::vector<std::string> frames_;
  std::vector<Rigid3d> frame_from_reference_;
  Eigen::MatrixXd covariance_;  // Of all frames but the first, which is the reference.
  double chi_square_ = 0.0;
  int redundancy_ = 0;
};

}  // namespace sextant
