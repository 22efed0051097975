// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "base/error.h"
#include "base/options.h"
#include "solvers/core/solver.h"
#include "solvers/least_squares/refine_pose.h"
#include "solvers/robust/pair_scorer.h"

namespace sextant {

/// When a pair counts as an inlier; shared by every solver that separates inliers from outliers.
struct InlierOptions {
  double threshold = 0.0;  ///< Sigmas; 0: 99 percent of true pairs are within.
  double sigma_m = 0.0;    ///< For pairs that state none; 0: estimated, see noise_scale.h.
  double sigma_px = 0.0;

  double Sigma(PairKind kind) const { return kind == PairKind::k3d3d ? sigma_m : sigma_px; }

  /// Largest squared whitened residual of an inlier: the 0.99 quantile of chi-square with 3 or 2
  /// degrees of freedom, or threshold^2.
  double MaxSquared(PairKind kind) const;

  /// The same for the final choice of inliers: among 3D-3D pairs the 0.9999 quantile where no
  /// threshold is set and hardly any false pair is expected within it. Leaving out one true pair in
  /// a hundred costs two percent of accuracy, and where few pairs are true the best four of five
  /// often look better than all five.
  double FinalMaxSquared(const PairScorer& scorer) const;
};

inline constexpr const char* kSigmaHelp =
    "noise of pairs that state none; 0: estimated from those that agree";

/// Adds threshold, sigma_m and sigma_px to a solver's options.
template <class Options>
OptionSet<Options>& AddInlierOptions(OptionSet<Options>& options) {
  return options
      .Real(
          "threshold", &Options::threshold, "sigma", 0.0, 1e6,
          "largest residual of an inlier; 0: 3.37 (3D-3D) or 3.03 (2D-3D), the 99 percent quantile")
      .Real("sigma_m", &Options::sigma_m, "m", 0.0, 1e6, kSigmaHelp)
      .Real("sigma_px", &Options::sigma_px, "px", 0.0, 1e6, kSigmaHelp);
}

/// Whether the pairs `inliers`, which agree on one pose, are more than chance explains.
///
/// A contrario (Moisan and Stival 2004): if all measurements were uniform in their bounding box, a
/// pair would agree with a given pose with probability p = RandomAgreementProbability. A pose
/// absorbs m pairs (2 of 3D-3D, 3 of 2D-3D), so the expected number of poses that k of n pairs
/// agree on is about C(n, m) P(Binomial(n - m, p) >= k - m); it must be under 0.01. Equal pairs
/// count once. Error: kNoConsensus, also for fewer than `min_inliers` inliers.
Expected<void> CheckConsensus(const PairScorer& scorer, double max_squared,
                              std::span<const int> inliers, int min_inliers);

/// The same, with their pose known: they may also be more than chance explains within the largest
/// of their residuals, of which each of the n - m is a threshold to be tried. Few pairs whose
/// residuals are all far below the limit are a consensus, too.
Expected<void> CheckConsensus(const PairScorer& scorer, const Rigid3d& pose, double max_squared,
                              std::span<const int> inliers, int min_inliers);

/// The minimum number of pairs, of whichever kind `needs` names.
int MinPairs(const DataNeeds& needs);

/// `inner` with one pair more of its kind, as a consensus requires.
DataNeeds NeedsOfConsensus(DataNeeds inner, PairKind kind);

/// The number of samples of `sample_size` of `count` pairs after which one with inliers only has
/// been drawn with probability `confidence`.
double WantedSamples(std::size_t count, std::size_t inliers, int sample_size, double confidence);

/// `inner` on the whole problem, which is not copied, and as its last stage.
Expected<Estimate> SolveWhole(const Solver& inner, const CalibrationProblem& problem);

/// `inner` on the pairs at `indices` only. The estimate's inliers are indices into the whole
/// problem; `inner` is its last stage.
Expected<Estimate> SolveSubset(const Solver& inner, const CalibrationProblem& problem,
                               std::span<const int> indices);

/// The pose of `inner` on the pairs at `indices`, without covariance or warnings; of several poses
/// the one with the smallest sum of squared residuals there. Requires as many pairs as `inner`
/// needs. Errors: those of `inner`.
Expected<Rigid3d> PoseOfSubset(const Solver& inner, const CalibrationProblem& problem,
                               const PairScorer& scorer, std::span<const int> indices);

/// The cheapest pose found by alternating between least squares on the inliers and choosing them
/// again, `pose` included. The squared threshold is four times max_squared in the first round and
/// is halved each round down to it, so that a pair just outside is not lost for good. Ends after
/// `rounds`, where there is no fit, or when the cost no longer falls. Source: Lebeda, Matas and
/// Chum 2012.
Rigid3d OptimiseOnInliers(PairScorer& scorer, const Rigid3d& pose, double max_squared, int rounds,
                          const RefineLimits& limits);

/// `inner` on all inliers of `pose`, repeated until the inliers stay the same (at most ten times).
/// The estimate's inliers are the pairs that it was solved from. Errors: kNoConsensus for fewer
/// inliers than `inner` needs, and those of `inner`.
Expected<Estimate> RefitOnInliers(const Solver& inner, const CalibrationProblem& problem,
                                  const PairScorer& scorer, const Rigid3d& pose,
                                  double max_squared);

/// `pose` as an estimate: its inliers, and the covariance of least squares on them at `pose`.
Estimate LeastSquaresOnInliers(const PairScorer& scorer, const Rigid3d& pose, double max_squared);

/// RefitOnInliers, unless `inner` fits the inliers of `pose` worse than `pose` does, as a minimal
/// solver or EPnP may; then least squares on them from `pose`. Where `inner` estimates the
/// rotation, `pose` must be near the minimum of least squares on its inliers.
Expected<Estimate> BetterOnInliers(const Solver& inner, const CalibrationProblem& problem,
                                   PairScorer& scorer, const Rigid3d& pose, double max_squared);

}  // namespace sextant
