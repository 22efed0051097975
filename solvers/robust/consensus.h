// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/options.h"
#include "solvers/alignment/isotropic_points.h"
#include "solvers/core/solver.h"
#include "solvers/least_squares/refine_pose.h"
#include "solvers/robust/pose_scorer.h"

namespace sextant {

/// When a pair counts as an inlier; shared by every combinator that tells inliers from outliers.
struct InlierOptions {
  double threshold = 0.0;  ///< Sigmas; 0: 99 percent of true pairs are within.
  double sigma_m = AssumedNoise{}.sigma_m;
  double sigma_px = AssumedNoise{}.sigma_px;

  AssumedNoise Assumed() const { return {sigma_m, sigma_px}; }

  /// Largest squared whitened residual of an inlier: the 0.99 quantile of chi-square with 3 or 2
  /// degrees of freedom, or threshold^2.
  double MaxSquared(PairKind kind) const;

  /// Of 3D-3D pairs, for the last word on who is an inlier: the 0.9999 quantile where no threshold
  /// is set and, as the probability `chance_at_9999` that a pair of chance is within it tells,
  /// hardly one of `count` is. Leaving out one true pair in a hundred costs two percent of
  /// accuracy, and where few are true the best four of five often look better than all five.
  double FinalMaxSquared(std::size_t count, double chance_at_9999) const;
};

/// The 0.9999 quantile of chi-square with 3 degrees of freedom.
inline constexpr double kChiSquare3At9999 = 21.107513466204896;

/// Adds threshold, sigma_m and sigma_px to a combinator's options.
template <class Options>
OptionSet<Options>& AddInlierOptions(OptionSet<Options>& options) {
  return options
      .Real(
          "threshold", &Options::threshold, "sigma", 0.0, 1e6,
          "largest residual of an inlier; 0: 3.37 (3D-3D) or 3.03 (2D-3D), the 99 percent quantile")
      .Real("sigma_m", &Options::sigma_m, "m", 1e-9, 1e6, "assumed of pairs that state no sigma")
      .Real("sigma_px", &Options::sigma_px, "px", 1e-6, 1e6,
            "assumed of pairs that state no sigma");
}

/// Whether `inlier_count` pairs that agree on one pose are more than chance.
///
/// A contrario (Moisan and Stival 2004): were all measurements uniform in their bounding box, a
/// pair would meet a given pose with probability p = volume within the threshold / volume of the
/// box. A pose absorbs m pairs (2 of 3D-3D, 3 of 2D-3D), so the expected number of poses that k of
/// n pairs agree on is about C(n, m) P(Binomial(n - m, p) >= k - m); it must be under 0.01.
/// The same pair given several times counts once. Error: kNoConsensus, for fewer than `least`
/// inliers too.
Expected<void> CheckConsensus(const PairTerms& terms, const PoseScorer& scorer,
                              std::span<const int> inliers, int least);

/// The same verdict on its numbers: so many different pairs of `count` agree on a pose, with the
/// probability `chance` that one of chance does.
Expected<void> CheckConsensus(PairKind kind, int distinct, int count, double chance, int least);

/// The probability that a pair of chance agrees with a pose; see above.
double RandomAgreementProbability(const PairTerms& terms, double max_squared);

/// The probability that a point of chance in `box`, grown by `radius`, is within it of another.
double RandomPointProbability(const Eigen::AlignedBox3d& box, double radius);

/// The least pairs of one kind that `needs` states.
int MinPairs(const DataNeeds& needs);

/// `inner` with one pair more of its kind, as a consensus takes.
DataNeeds NeedsOfConsensus(DataNeeds inner, PairKind kind);

/// How many samples of `sample_size` of `count` pairs to draw until one of inliers only has been
/// drawn with this probability.
double WantedSamples(std::size_t count, std::size_t inliers, int sample_size, double confidence);

/// Writes the indices of a pose's inliers.
using FindInliers = std::function<void(const Rigid3d& pose, std::vector<int>& inliers)>;

/// `inner` on all inliers of `pose`, again and again until the inliers stay the same (at most ten
/// times). The estimate's inliers are those it was solved from, as indices of the whole problem;
/// `inner` is added to its stages. Errors: kNoConsensus for fewer inliers than `inner` needs, and
/// those of `inner`.
Expected<Estimate> RefitOnInliers(const Solver& inner, const CalibrationProblem& problem,
                                  const FindInliers& find_inliers, const Rigid3d& pose);

/// The same, by the scorer's threshold.
Expected<Estimate> RefitOnInliers(const Solver& inner, const CalibrationProblem& problem,
                                  const PoseScorer& scorer, const Rigid3d& pose);

/// The pose of `inner` on the pairs at `indices`, without covariance and so on; of several, the one
/// with the smallest sum of squared residuals there. Requires as many as `inner` needs. Errors:
/// those of `inner`.
Expected<Rigid3d> PoseOfSubset(const Solver& inner, const CalibrationProblem& problem,
                               const PairTerms& terms, std::span<const int> indices);

/// `inner` on the pairs at `indices` only; the estimate speaks of the whole problem's indices and
/// has `inner` as its last stage.
Expected<Estimate> SolveSubset(const Solver& inner, const CalibrationProblem& problem,
                               std::span<const int> indices);

/// `inner` on the whole problem, which is not copied, and as its last stage.
Expected<Estimate> SolveWhole(const Solver& inner, const CalibrationProblem& problem);

/// Buffers of OptimiseOnInliers, to be kept between calls.
struct InlierWorkspace {
  std::vector<int> inliers;
  PairTerms terms;
  PointBuffers buffers;
};

/// The cheapest pose met by alternating least squares on the inliers with choosing them, `pose`
/// included. The first rounds choose generously, so that a pair just outside is not lost for good;
/// ends after `rounds` or when the cost no longer falls. Source: Lebeda, Matas and Chum 2012.
Rigid3d OptimiseOnInliers(const PairTerms& terms, const PoseScorer& scorer, const Rigid3d& pose,
                          int rounds, const RefineLimits& limits, InlierWorkspace& workspace);

/// `pose` as an estimate: its inliers, and the covariance of least squares on them at `pose`.
Estimate LeastSquaresOnInliers(const PairTerms& terms, const PoseScorer& scorer,
                               const Rigid3d& pose);

/// RefitOnInliers, unless `inner` fits the inliers of `pose` worse than `pose` does, as a minimal
/// solver or EPnP may; then LeastSquaresOnInliers. `pose` is a minimum of least squares on them
/// where `inner` estimates the rotation.
Expected<Estimate> BetterOnInliers(const Solver& inner, const CalibrationProblem& problem,
                                   const PairTerms& terms, const PoseScorer& scorer,
                                   const Rigid3d& pose);

}  // namespace sextant
