// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solvers/joint/joint_problem.h"

namespace sextant {

/// A shared parameter besides the pose that the views do not determine well enough to be useful.
struct UnobservableParameter {
  int index = 0;        ///< Into the shared unknowns.
  double sigma = 0.0;   ///< Standard deviation, in its unit.
  double useful = 0.0;  ///< Above this sigma it counts as unobservable.
};

/// The largest useful sigma of each shared unknown besides the pose: 5 cm of range bias, 5 percent
/// of a size, and for an intrinsic a shift of the pixels of the views by 5 percent of the focal
/// length.
Eigen::VectorXd UsefulSigmas(const std::vector<JointView>& views, const JointUnknowns& unknowns,
                             const JointState& state, std::span<const Board> boards);

/// The unknown with the largest sigma relative to `useful` (UsefulSigmas); none where all are
/// observable. A prior a thousand times as wide as `useful` is added, so that a parameter without
/// any information has a finite sigma too.
std::optional<UnobservableParameter> FindUnobservable(const Eigen::MatrixXd& information,
                                                      const Eigen::VectorXd& useful);

/// Removes that parameter from the unknowns, the views and the state, together with its partner
/// (both sides of that board, both focal lengths, both coordinates of the centre).
void FixParameter(int unknown, const CalibrationProblem& problem, JointUnknowns& unknowns,
                  std::vector<JointView>& views, JointState& state);

/// "range_bias_m", "board_scale", "board_0_top_right_m", "fx_px".
std::string NameOf(const JointUnknowns& unknowns, const Camera& camera, int unknown);

/// The sentence for Estimate::warnings.
std::string DescribeUnobservable(const UnobservableParameter& unobservable,
                                 const JointUnknowns& unknowns, const Camera& camera);

}  // namespace sextant
