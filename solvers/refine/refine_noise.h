// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/error.h"
#include "solvers/core/solver.h"
#include "solvers/refine/refine_options.h"

namespace sextant {

/// The pairs of a refinement, with the noise that least squares and losses need.
class RefinedPairs {
 public:
  /// Copies the pairs at these indices.
  RefinedPairs(const CalibrationProblem& problem, std::span<const int> points,
               std::span<const int> pixels);

  /// Sets the noise of pairs that state none: that of the options; else
  /// - nothing, for least squares on pairs of one kind, which do not depend on it;
  /// - for a loss, that of FindNoiseScale, whose pose becomes a second start (MM-estimation, Yohai
  ///   1987);
  /// - for least squares on both kinds, the variances under which the squared residuals of each
  ///   kind have their expected sum at the minimum, iterated from `start` (Helmert's variance
  ///   components).
  /// Errors: those of FindNoiseScale.
  Expected<void> EstimateNoise(const RefineOptions& options, const Solver& inner,
                               const Estimate& start);

  PairTerms Terms() const;
  std::span<const Rigid3d> starts() const { return starts_; }
  /// None where nothing was set.
  const std::optional<NoiseEstimate>& noise() const { return noise_; }

 private:
  bool IsUnstated(PairKind kind) const;
  void SetSigma(PairKind kind, double sigma);
  Expected<void> FindScale(PairKind kind, const Solver& inner);
  void BalanceKinds(const Rigid3d& start);

  CalibrationProblem problem_;
  std::vector<Rigid3d> starts_;
  std::optional<NoiseEstimate> noise_;
};

}  // namespace sextant
