// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "solvers/robust/pair_scorer.h"

namespace sextant {

/// The diagonal [m or px] of the box around the camera points, or pixels, of the pairs.
double ExtentOf(const CalibrationProblem& problem, PairKind kind);

/// The number of pairs that a pose explains best, and how unlikely that is.
struct ScaleRating {
  double log_false_alarms = 0.0;  ///< log NFA of FindNoiseScale, at its minimum over k.
  double max_squared = 0.0;       ///< No pair used has a larger squared residual [m^2 or px^2].
  int inliers = 0;                ///< k
};

/// The best ratings that leave out at least these shares of the pairs: none, a sixth, two fifths.
inline constexpr std::array<double, 3> kRatedShares = {1.0, 5.0 / 6.0, 0.6};
using ScaleRatings = std::array<ScaleRating, kRatedShares.size()>;

/// Rates the residuals of a pose at every scale. Residuals are counted by quarters of octaves of
/// their squares, so a rating takes time N + 200 and no sorting.
class ScaleRater {
 public:
  /// Pairs of `scorer` must state no noise; `extent` is that of ExtentOf. A pose fits `absorbed`
  /// pairs whatever they are.
  ScaleRater(const PairScorer& scorer, double extent, int absorbed);

  /// Residuals below this are rounding errors, and count as equal.
  double min_squared() const { return upper_.front(); }

  /// The best rating for each of kRatedShares. Squared residuals that are not numbers count as
  /// infinite.
  ScaleRatings Rate(std::span<const double> squared) const;

 private:
  static constexpr std::size_t kBins = 200;

  std::size_t size_;
  std::size_t absorbed_;
  std::int64_t first_ = 0;              // Leading bits of the lowest bin.
  std::array<double, kBins> upper_{};   // Largest square of a bin.
  std::array<double, kBins> chance_{};  // log p there.
  std::vector<double> log_tests_;       // log((n - m) C(n, k) C(k, m)) by k, m = absorbed.
};

/// Logarithm of the expected number of choices of `inliers` of `count` pairs whose squares would
/// add up to `squares` or less by noise alone, where those of all pairs about their own best pose
/// add up to `squares_of_all`; 0 where it is not small.
///
/// If one Gaussian explained all pairs, leaving out m of them would be a linear hypothesis with the
/// F-test of m `dimension` and f = `inliers` `dimension` - 6 degrees of freedom: C(count, m) P(F).
/// P(F) is bounded from above by x^a (1 - x)^(b - 1) / B(a, b), with x = squares / squares_of_all,
/// a = f / 2, b = m `dimension` / 2.
double LogChanceOfSelection(int dimension, std::size_t count, std::size_t inliers, double squares,
                            double squares_of_all);

/// The variance per axis of a Gaussian of `dimension` axes, cut off at the square `max_squared`,
/// from the squares up to that; `unknowns` were fitted to these. No less than 0.
double VarianceWithin(std::span<const double> squared, int dimension, double unknowns,
                      double max_squared);

}  // namespace sextant
