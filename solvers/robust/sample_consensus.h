// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "base/random.h"
#include "solvers/core/solver.h"
#include "solvers/kernels/pair_columns.h"
#include "solvers/least_squares/refine_pose.h"
#include "solvers/robust/column_consensus.h"
#include "solvers/robust/consensus.h"
#include "solvers/robust/pose_scorer.h"

namespace sextant {

/// How a consensus search judges poses: by terms of any kind and noise.
class TermsConsensus {
 public:
  TermsConsensus(const PairTerms& terms, const PoseScorer& scorer)
      : terms_(terms), scorer_(scorer) {
    workspace_.inliers.reserve(terms.size());
    workspace_.terms.points.reserve(terms.points.size());
    workspace_.terms.pixels.reserve(terms.pixels.size());
  }

  std::size_t size() const { return terms_.size(); }

  /// The cost, or any number from `give_up` on where it is no less.
  double Cost(const Rigid3d& pose, double give_up) const { return scorer_.Cost(pose, give_up); }

  std::size_t CountInliers(const Rigid3d& pose) {
    scorer_.Inliers(pose, workspace_.inliers);
    return workspace_.inliers.size();
  }

  Rigid3d Optimise(const Rigid3d& pose, int rounds, const RefineLimits& limits) {
    return OptimiseOnInliers(terms_, scorer_, pose, rounds, limits, workspace_);
  }

 private:
  const PairTerms& terms_;
  const PoseScorer& scorer_;
  InlierWorkspace workspace_;
};

/// The same by columns of isotropic 3D-3D pairs: half the memory, no copies of the inliers.
class ColumnsConsensus {
 public:
  ColumnsConsensus(const PairColumns& pairs, double max_squared)
      : pairs_(pairs), max_squared_(max_squared) {}

  std::size_t size() const { return pairs_.size(); }
  double Cost(const Rigid3d& pose, double) const {
    return TruncatedCost(pairs_, pose, max_squared_);
  }
  std::size_t CountInliers(const Rigid3d& pose) const {
    return static_cast<std::size_t>(FitInliers(pairs_, pose, max_squared_).inliers);
  }
  Rigid3d Optimise(const Rigid3d& pose, int rounds, const RefineLimits&) const {
    return OptimiseOnInliers(pairs_, pose, max_squared_, rounds);
  }

 private:
  const PairColumns& pairs_;
  double max_squared_;
};

struct SampleOptions {
  int sample_size = 3;
  int max_iterations = 10000;
  double confidence = 0.999;
  int local_optimisation = 10;  ///< Rounds; 0: none.
  std::uint64_t seed = 1;
};

/// The cheapest pose of random samples of pairs. Every buffer is allocated before the search, none
/// in its loop.
template <class Consensus>
class SampleSearch {
 public:
  SampleSearch(const Solver& inner, const SampleOptions& options, const CalibrationProblem& problem,
               Consensus& consensus)
      : inner_(inner),
        options_(options),
        problem_(problem),
        consensus_(consensus),
        random_(options.seed),
        sample_(static_cast<std::size_t>(options.sample_size)) {
    poses_.reserve(8);
  }

  void Run() {
    // After this many degenerate samples and no other, the data itself is degenerate.
    constexpr int kMaxDegenerateSamples = 1000;
    double wanted = options_.max_iterations;
    while (iterations_ < wanted && (found_ || iterations_ < kMaxDegenerateSamples)) {
      ++iterations_;
      random_.Sample(static_cast<int>(consensus_.size()), sample_);
      poses_.clear();
      inner_.Hypothesize(problem_, sample_, poses_);
      for (const Rigid3d& pose : poses_) {
        if (!Offer(pose)) continue;
        if (options_.local_optimisation > 0) {
          Optimise({.max_iterations = 4, .step_tolerance = 1e-6});
        }
        wanted = std::min<double>(options_.max_iterations,
                                  WantedSamples(consensus_.size(), consensus_.CountInliers(best_),
                                                options_.sample_size, options_.confidence));
      }
    }
    if (found_) Optimise({.max_iterations = 30, .step_tolerance = 1e-10});
  }

  bool found() const { return found_; }
  const Rigid3d& best() const { return best_; }
  int iterations() const { return iterations_; }

 private:
  void Optimise(const RefineLimits& limits) {
    if (!inner_.spec().estimates_rotation) return;
    Offer(consensus_.Optimise(best_, options_.local_optimisation, limits));
  }

  // Takes a pose that costs less than the best.
  bool Offer(const Rigid3d& pose) {
    if (!pose.IsFinite()) return false;
    const double cost = consensus_.Cost(pose, best_cost_);
    if (found_ && !(cost < best_cost_)) return false;
    best_cost_ = cost;
    best_ = pose;
    found_ = true;
    return true;
  }

  const Solver& inner_;
  const SampleOptions& options_;
  const CalibrationProblem& problem_;
  Consensus& consensus_;
  Random random_;
  std::vector<int> sample_;
  std::vector<Rigid3d> poses_;
  Rigid3d best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
  bool found_ = false;
  int iterations_ = 0;
};

}  // namespace sextant
