// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/error.h"
#include "solvers/core/solver.h"
#include "solvers/kernels/bit_graph.h"
#include "solvers/kernels/pair_columns.h"
#include "solvers/robust/consensus.h"

namespace sextant {

/// What a search among 3D-3D pairs asks of them: which agree, what poses cost, least squares on the
/// inliers of a pose, and the answer from it. The threshold of lengths is MaxSquared of the
/// options, that of poses their FinalMaxSquared.
class PairScorer {
 public:
  virtual ~PairScorer() = default;

  /// Pairs i and j are connected where their lengths from i to j in both frames differ by no more
  /// than the threshold of its sigma.
  virtual BitGraph Graph() const = 0;
  /// sum_i min(r_i^2, threshold), r_i in sigmas.
  virtual double Cost(const Rigid3d& pose) const = 0;
  /// OptimiseOnInliers of consensus.h.
  virtual Rigid3d Optimise(const Rigid3d& pose) const = 0;
  /// CheckConsensus of consensus.h, by the options' MaxSquared.
  virtual Expected<void> Check(std::span<const int> inliers, int least) const = 0;
  /// BetterOnInliers of consensus.h.
  virtual Expected<Estimate> Answer(const Rigid3d& pose) const = 0;
};

/// Of isotropic pairs, which are judged in columns, or of any. Refers to its arguments.
std::unique_ptr<PairScorer> MakePairScorer(const Solver& inner, const CalibrationProblem& problem,
                                           const InlierOptions& options);

/// Whether no pair states a covariance.
bool AreIsotropic(std::span<const Pair3d3d> pairs);

/// CheckConsensus of consensus.h on columns.
Expected<void> CheckConsensus(const PairColumns& pairs, double max_squared,
                              std::span<const int> inliers, int least);

/// RefitOnInliers of consensus.h on columns.
Expected<Estimate> RefitOnInliers(const Solver& inner, const CalibrationProblem& problem,
                                  const PairColumns& pairs, const Rigid3d& pose,
                                  double max_squared);

/// The same; none where the inner solver fits worse than `pose` does, or not at all.
std::optional<Estimate> RefitIfNoWorse(const Solver& inner, const CalibrationProblem& problem,
                                       const PairColumns& pairs, const Rigid3d& pose,
                                       double max_squared);

}  // namespace sextant
