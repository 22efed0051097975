// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant {

/// The RMS residual of the pairs that an answer uses, over the RMS distance of their camera points,
/// or pixels, from their mean [-]: about 0 for correspondences, near 1 for unrelated points. Pixels
/// that spread over more than a fifth of the focal length (11 deg) count as if they spread over
/// that, because a wide image makes no corner less certain, and their residual is that of noise
/// which leaves as much after six unknowns. None for problems with both kinds of pairs or without
/// pairs, and for fewer than four used ones. O(n).
std::optional<double> UnexplainedShare(const CalibrationProblem& problem,
                                       const SolveReport& report);

/// A larger share explains nothing: measurements of boards are at a tenth even where the noise is
/// large.
inline constexpr double kMaxUnexplainedShare = 0.3;

/// Most measurements leave less; where a cause is known, this is enough to refuse the answer.
inline constexpr double kUsualUnexplainedShare = 0.2;

/// The same of all pairs, whether the answer uses them or not; infinite where one does not project.
std::optional<double> UnexplainedShareOfAll(const CalibrationProblem& problem,
                                            const SolveReport& report);

/// The logarithm of the expected number of poses of three of the pairs that, by chance, as many of
/// n pairs as the answer uses would be so close to:
///   (n - 3) C(n, k) C(k, 3) p^(k - 3),
/// k pairs used, p the share of the extent of the measurements within the largest residual of those
/// (Moisan and Stival 2004). Above 0 for three of four or more, which fit some pose whatever they
/// are. None for an answer that uses all pairs, or of both kinds.
std::optional<double> LogChanceOfUsed(const CalibrationProblem& problem, const SolveReport& report);

/// How many times as far from the camera as from the LiDAR the points of an answer to pixels are,
/// in the root of the mean square [-]. Poses for pixels or points in a wrong unit move the camera
/// away until all points are near the one pixel that explains them least badly. None without
/// pixels.
std::optional<double> DistanceRatio(const CalibrationProblem& problem, const SolveReport& report);

/// A larger ratio is none of two sensors near each other; points of a board or another frame than
/// the LiDAR's may have any.
inline constexpr double kMaxDistanceRatio = 2.0;

/// A sentence where the distance ratio is larger, and residuals show that something is wrong.
std::optional<std::string> DescribeDistance(const CalibrationProblem& problem,
                                            const SolveReport& report);

/// Why the answer is not usable, as the rest of "NOT USABLE: ...", where it explains nothing
/// (kMaxUnexplainedShare), where it is based on pairs that chance explains while the others
/// contradict it, or where a poor answer has the camera far away (DescribeDistance). None else.
std::optional<std::string> WhyUnusable(const CalibrationProblem& problem,
                                       const SolveReport& report);

/// Whether an answer speaks for a pose: it is based on half of the pairs or more, or on fewer that
/// are far beyond chance, which errors in common, as of a wrong camera, let five or six of twenty
/// be.
bool IsSupported(const CalibrationProblem& problem, const SolveReport& report);

/// A sentence where an answer leaves out pairs that are no outliers but for the noise that the used
/// ones show: chosen from a few as those that fit best, these show too small a noise.
std::optional<std::string> DescribeSelection(const CalibrationProblem& problem,
                                             const SolveReport& report);

/// A sentence where the answer to pairs that state no noise leaves more than a fifth of their
/// spread: more than measurements usually do, but less than kMaxUnexplainedShare may be.
std::optional<std::string> DescribeMisfit(const CalibrationProblem& problem,
                                          const SolveReport& report);

}  // namespace sextant
