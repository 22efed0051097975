// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "solvers/joint/board_view_information.h"
#include "solvers/joint/joint_problem.h"

namespace sextant {

/// The covariance of everything that a linearisation estimates, the boards' poses eliminated.
/// O(views shared^2) time and O(views shared) memory.
class JointCovariance {
 public:
  /// None where the pose or a shared number is undetermined.
  static std::optional<JointCovariance> Of(const JointLinearisation& at);

  /// For (dphi, dt) of cam_from_lidar and the shared numbers.
  const Eigen::MatrixXd& shared() const { return shared_; }

  /// For the shared numbers and the 12 of a view's poses. Directions of the latter without
  /// information count as known.
  Eigen::MatrixXd WithView(std::size_t view) const;

 private:
  Eigen::MatrixXd shared_;
  std::vector<Matrix12d> views_;                                      ///< Shared numbers given.
  std::vector<Eigen::Matrix<double, 12, Eigen::Dynamic>> by_shared_;  ///< Slope of the minimum.
};

/// How the residuals of a linearisation compare with what is expected of them.
struct KindSum {
  double squares = 0.0;     ///< Sum over the weighted residuals.
  double redundancy = 0.0;  ///< Their expected sum: the rows' number less their leverages.

  KindSum& operator+=(const KindSum& other) {
    squares += other.squares;
    redundancy += other.redundancy;
    return *this;
  }
};

struct ViewSums {
  KindSum printed;
  KindSum face;
  KindSum edges;
  KindSum out_of_plane;  ///< LinkError across the plane.
  KindSum in_plane;
  /// Squared norm of LinkError where this view's link is without weight, whitened by its
  /// covariance with the noise that a used view has: chi-square distributed.
  double contradiction = 0.0;
  int freedom = 0;
};

/// One for each view. Observations of weight 0 do not count.
std::vector<ViewSums> SumsOf(const JointLinearisation& at, const JointCovariance& covariance);

/// The sum over the offsets of the rings, over `ratio` times the sigmas of their priors.
KindSum RingSumOf(const JointModel& model, const JointState& state,
                  const JointCovariance& covariance, double ratio);

}  // namespace sextant
