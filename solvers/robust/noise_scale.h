// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "base/error.h"
#include "solvers/core/solver.h"
#include "solvers/robust/consensus.h"

namespace sextant {

/// The noise of the pairs that agree on a pose.
struct NoiseScale {
  Rigid3d cam_from_lidar;  ///< Least squares on these pairs.
  double sigma = 0.0;      ///< Standard deviation per axis, m or px.
  int inliers = 0;
};

/// Seed of FindNoiseScale for solvers without one.
inline constexpr std::uint64_t kScaleSeed = 1;

/// Finds the noise of pairs that state none, and of which many may be outliers, without a
/// threshold.
///
/// A contrario (Moisan and Stival 2004; Moulon, Monasse and Marlet 2012, AC-RANSAC): poses of
/// random triples are rated by the expected number of poses that k of n random pairs would be so
/// close to,
///   NFA = min over k of (n - 3) C(n, k) C(k, 3) p(e_k)^(k - 3),
/// e_k the k-th smallest residual and p the probability that a random pair has at most that
/// (RandomAgreementProbability). Least squares on the best k follows each improvement. Fewer pairs
/// are taken where noise alone would not leave these so close to a pose (LogChanceOfSelection): all
/// pairs may rate better than either of two groups that contradict each other. The sigma is
/// that of the Gaussian cut off at e_k, then of the pairs within 99 percent of it, repeated until
/// these stay the same. It is at least 1e-7 of the extent of the measurements; p is that of at
/// least 1e-4 of it.
///
/// 3D-3D pairs: of each 1024 triples only those whose lengths agree best in both frames are tried,
/// so that 95 percent of outliers take a few milliseconds. 2D-3D: P3P. Where `inner` keeps the
/// rotation, it makes the poses. Time N per pose; 0.1 to 1 ms for 100 pairs.
/// Errors: kNoConsensus (NFA of 0.01 or more), kDegenerate (no triple has a pose).
Expected<NoiseScale> FindNoiseScale(const CalibrationProblem& problem, PairKind kind,
                                    const Solver& inner, std::uint64_t seed);

/// The pose of FindNoiseScale for the pairs, without the noise that they state: a start where
/// outliers leave a solver of all pairs no pose. Errors: those of FindNoiseScale.
Expected<Rigid3d> FindConsensusPose(const CalibrationProblem& problem, PairKind kind,
                                    const Solver& inner);

/// The pairs of one kind with that sigma, and what solvers of pairs need besides.
CalibrationProblem WithSigma(const CalibrationProblem& problem, PairKind kind, double sigma);

/// A robust solver's method, which needs pairs that state their noise.
using MethodForKnownNoise = std::function<Expected<Estimate>(const CalibrationProblem&)>;

/// `solve` with the noise that the pairs state; else with that of the options; else with that of
/// FindNoiseScale, repeated with the noise of the inliers while that differs by more than 20
/// percent. The covariance is then that of the noise of the inliers, which is in Estimate::noise.
Expected<Estimate> SolveWithNoise(const CalibrationProblem& problem, PairKind kind,
                                  const InlierOptions& options, const Solver& inner,
                                  std::uint64_t seed, const MethodForKnownNoise& solve);

}  // namespace sextant
