// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/diagnostics/board_contradiction.h"
#include "eval/diagnostics/order_diagnostics.h"
#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant {

/// A board whose edges differ between the sensors, or from the nominal size, by more than noise
/// explains.
struct EdgeFinding {
  int view = 0;
  int board = 0;
  int edge = 0;  ///< The edge from corner `edge` to the next one; the one that differs most.
  double in_cam_m = 0.0;
  double in_lidar_m = 0.0;
  std::optional<double> known_m;
};

/// A direction of the pose that the geometry determines far less well than the best one.
struct WeakDirection {
  bool is_rotation = false;
  Eigen::Vector3d axis_in_cam = Eigen::Vector3d::Zero();  ///< Unit vector.
  double sigma = 0.0;                                     ///< One standard deviation, rad or m.
  /// Standard deviation of the best determined direction of the same kind.
  double best_sigma = 0.0;
};

/// Data diagnostics: properties of the pairs that make a pose from them unreliable.
struct PairDiagnostics {
  std::vector<std::string> causes;  ///< See causes.h; one sentence each.
  bool misread = false;  ///< One of them is in the points or pixels: they are not what they seem.
  OrderDiagnosis order;
  std::optional<BoardContradiction> contradiction;
  std::vector<EdgeFinding> edges;
  std::optional<WeakDirection> weak_rotation;
  std::optional<WeakDirection> weak_translation;
  /// RMSE of the best reflection, set only if it is less than half that of the best rotation.
  std::optional<double> mirrored_rmse_m;
};

/// Looks for one cause that explains the data (causes.h); where the points have one, nothing else
/// is said of them. Checks the pairs for a wrong order (DiagnoseOrder), and the 3D-3D pairs, in the
/// better order, for boards that contradict each other, wrong edges, mirrored data and weak
/// directions; empty for a problem with too few pairs. O(n log n) time and O(n) memory in the
/// number of pairs: 10^4 pairs take less than 0.3 s.
///
/// Contradiction: see FindContradiction. Edges: reported if they differ by more
/// than 5 percent of their length and, if the noise is stated, by more than one of all edges does
/// by noise with a probability of 1 %; not where a common factor explains them. Weak direction: not
/// where the pairs do not fit; its standard deviation, for points about a
/// far origin that at their centre, is more than five times that of the best determined direction.
PairDiagnostics DiagnosePairs(const CalibrationProblem& problem);

/// Whether no pose of these pairs, in the order that is used, can be right: they are not what they
/// are taken for, mirrored, in an order that puts the sensors on opposite sides of the boards or
/// fits far worse than another, or of boards that contradict each other so that none can be told to
/// be right. `reordered`: the better order is used.
bool RefutesPoses(const PairDiagnostics& diagnostics, bool reordered);

/// The diagnostics for an answer that uses only some of the 3D-3D pairs, which determine its weak
/// directions. Without 3D-3D pairs, and for an answer that uses all of them, as they are.
PairDiagnostics ForAnswer(PairDiagnostics diagnostics, const CalibrationProblem& problem,
                          const SolveReport& report);

/// One line of text per finding, with the figures and advice; pairs by their place in the file,
/// from which `repeated` ones have been removed.
std::vector<std::string> Describe(const PairDiagnostics& diagnostics,
                                  std::span<const RepeatedPairs> repeated = {});

}  // namespace sextant
