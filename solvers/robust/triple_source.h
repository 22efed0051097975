// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "geometry/rigid3d.h"
#include "solvers/core/solver.h"
#include "solvers/kernels/pair_terms.h"

namespace sextant {

/// Poses from random samples of pairs, for a search that knows no noise yet.
class TripleSource {
 public:
  virtual ~TripleSource() = default;

  /// Appends the poses of the next samples.
  virtual void Next(std::vector<Rigid3d>& poses) = 0;

  /// Number of samples drawn, and limits of it.
  int samples() const { return samples_; }
  int min_samples() const { return min_samples_; }
  int max_samples() const { return max_samples_; }

 protected:
  TripleSource(int min_samples, int max_samples)
      : min_samples_(min_samples), max_samples_(max_samples) {}
  void Count(int samples) { samples_ += samples; }

 private:
  int samples_ = 0;
  int min_samples_;
  int max_samples_;
};

/// See FindNoiseScale; the first poses are those of `inner` on all pairs. Refers to its arguments.
std::unique_ptr<TripleSource> MakeTripleSource(const CalibrationProblem& problem, PairKind kind,
                                               const Solver& inner, std::uint64_t seed);

}  // namespace sextant
