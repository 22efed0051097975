// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "geometry/calibration_problem.h"

namespace sextant {

struct Estimate;
struct SolverSpec;

/// How the covariance of an answer treats the errors of pairs of one board.
enum class BoardErrors {
  kAssumedIndependent,  ///< No two pairs are known to be of one board and view.
  kTooFewBoards,        ///< Three boards or fewer: too few to estimate one; assumed independent.
  kEstimated,           ///< An error common to the pairs of a board and view was estimated.
};

/// The name in result files: "assumed_independent", "too_few_boards", "estimated".
std::string_view ToString(BoardErrors errors);

/// The noise of pairs that state none. Of exact pairs, as made without noise, it is what rounding
/// makes, with a warning, and so is the covariance of the answer: neither is ever zero.
struct NoiseEstimate {
  /// Standard deviation per axis of the pairs used; of one kind only, unless both were used.
  std::optional<double> sigma_m;
  std::optional<double> sigma_px;
  bool is_given = false;  ///< By an option of the solver; all else was estimated.
  BoardErrors board_errors = BoardErrors::kAssumedIndependent;
  int boards = 0;             ///< Number of boards and views among the pairs used.
  double shared_sigma = 0.0;  ///< The part of the sigma that the pairs of a board share [m or px].
  double freedom = 0.0;       ///< Effective degrees of freedom of the covariance; 0: not known yet.
};

/// Estimates the noise and completes the covariance of an answer, where the pairs that `spec` needs
/// state no noise: once, at the end of a solve. Sets `estimate.noise`, unless that is complete.
///
/// The error of pair j of board g is b_g + e_gj, with one common error per board and view. With
/// residuals r and derivatives J by the pose at the answer, H = sum J^T J, S_g = sum_j J_gj and
/// B = sum_g S_g^T S_g, least squares has the covariance
///   V = H^-1 (s_e^2 H + s_b^2 B) H^-1.
/// The variances s_e^2, s_b^2 are those for which the sum of squares, and that of the means of the
/// boards, have their expected values (Henderson 1953, fitting of constants), and not negative. A
/// solver with covariance C under independent errors gets L C L^T with V = L V_0 L^T,
/// V_0 = s^2 H^-1, L symmetric where V_0 is the unit matrix: V for least squares.
///
/// As the variances of few boards are estimates with f effective degrees of freedom (Satterthwaite
/// 1946), the covariance of correlated pairs is multiplied by 6 F(6, f) / chi2(6), quantiles at 95
/// percent: then the 95 percent region of a Gaussian is that of the answer. Independent pairs keep
/// the least-squares covariance s^2 H^-1, and `freedom` states how well s is known. Time N log N.
void CompleteNoise(const CalibrationProblem& problem, const SolverSpec& spec, Estimate& estimate);

}  // namespace sextant
