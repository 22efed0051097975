// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solvers/joint/joint_problem.h"

namespace sextant {

/// An unknown beside the pose of which the views tell nothing that is worth having.
struct UnobservableParameter {
  int unknown = 0;      ///< Among the shared unknowns.
  double sigma = 0.0;   ///< What is known of it, in its unit.
  double useful = 0.0;  ///< More than this is no knowledge.
};

/// What counts as knowledge of each shared unknown beside the pose: 5 cm of range bias, 5 percent
/// of a size, 5 percent of the focal length in what an intrinsic does to a pixel of the views.
Eigen::VectorXd UsefulSigmas(const std::vector<JointView>& views, const JointUnknowns& unknowns,
                             const JointState& state, std::span<const Board> boards);

/// The unknown that is told worst, in units of what is useful; none where all are told. `useful` as
/// above; it stands in as a prior a thousand times as wide, so that what the views do not tell at
/// all has a sigma too.
std::optional<UnobservableParameter> FindUnobservable(const Eigen::MatrixXd& information,
                                                      const Eigen::VectorXd& useful);

/// The unknowns without that one (and its fellow: both sides of that board, both focal lengths,
/// both coordinates of the centre), and a state without it.
void LeaveOut(int unknown, const CalibrationProblem& problem, JointUnknowns& unknowns,
              std::vector<JointView>& views, JointState& state);

/// "range_bias_m", "board_scale", "board_0_top_right_m", "fx_px".
std::string NameOf(const JointUnknowns& unknowns, const Camera& camera, int unknown);

/// The sentence for Estimate::warnings.
std::string DescribeUnobservable(const UnobservableParameter& untold, const JointUnknowns& unknowns,
                                 const Camera& camera);

}  // namespace sextant
