// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/crs_matrix.h>
#include <ceres/problem.h>

#include <array>
#include <vector>

#include "solvers/blocks/pose_manifold.h"
#include "solvers/blocks/schur_minimum.h"
#include "solvers/joint/joint_model.h"

namespace sextant {

/// Factors of the whitened residuals of one view; 0 leaves an observation out.
struct JointWeights {
  std::vector<double> printed;
  std::vector<double> face;
  std::vector<double> edges;
  Vector6d link = Vector6d::Zero();  ///< Weights of LinkError [1/m].
  double link_factor = 0.0;          ///< The part of `link` that is not 1 / noise.
};

enum class JointKind { kPrinted, kFace, kEdges, kLink };

/// Rows of a linearisation: consecutive residuals of one kind and view.
struct JointRows {
  JointKind kind;
  std::size_t view = 0;
  std::size_t part = 0;  ///< Which of the view's prints, or groups of face returns.
  int first = 0;
  int count = 0;
  int observed = 0;  ///< Number of residuals with weight that the rows condense.
};

/// Weighted residuals and their derivative by (dphi, dt) of cam_from_lidar, then the shared blocks,
/// then (dphi, dt) of both poses of each view.
struct JointLinearisation {
  int shared = 0;  ///< Columns before those of the views.
  std::size_t views = 0;
  std::vector<double> residuals;
  ceres::CRSMatrix derivative;
  std::vector<JointRows> rows;       ///< Those of the priors are in none.
  std::vector<double> link_factors;  ///< JointWeights::link_factor of each view.
};

/// argmin of 1/2 sum |w r|^2 over cam_from_lidar, the poses of every board and the shared blocks,
/// as a ceres::Problem. A view's two poses are one parameter block, which the Schur complement
/// eliminates, so that an iteration is linear in the number of views (Triggs et al. 2000).
class JointProblem {
 public:
  JointProblem(const JointModel& model, const JointState& start);
  JointProblem(const JointProblem&) = delete;
  JointProblem& operator=(const JointProblem&) = delete;

  const JointState& state() const { return state_; }

  /// One for each view, and that of the priors of the rings' offsets.
  void SetWeights(const std::vector<JointWeights>& weights, double ring_weight);

  SchurSteps Solve(int max_iterations, double step_tolerance);

  JointLinearisation Linearise();

 private:
  void AddViews();
  void AddShared();
  void StoreState();
  int ObservedIn(const JointRows& rows) const;
  void Add(JointRows rows, ceres::CostFunction* cost, const std::vector<double*>& blocks);

  const JointModel& model_;
  JointState state_;
  std::vector<JointWeights> weights_;
  double ring_weight_ = 1.0;
  std::array<double, kPoseNumbers> cam_from_lidar_{};
  std::vector<std::array<double, 2 * kPoseNumbers>> boards_;
  std::vector<ceres::ResidualBlockId> residuals_;
  std::vector<JointRows> rows_;
  int row_count_ = 0;
  ceres::Problem problem_;
};

}  // namespace sextant
