// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "base/random.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/agreement_graph.h"
#include "solvers/robust/column_scorer.h"
#include "solvers/robust/consensus.h"
#include "solvers/robust/noise_scale.h"

namespace sextant {

SolverEntry CliqueEntry();

namespace {

struct RobustOptions : InlierOptions {
  double confidence = 0.9999;
  std::uint64_t seed = 1;
};

/// Samples triples of pairs that agree on their three lengths and finds the cheapest of their poses
/// after least squares on the inliers. A triple with outliers costs at most three comparisons:
/// hardly any agrees.
class TripleSearch {
 public:
  TripleSearch(const Solver& inner, const CalibrationProblem& problem, ColumnScorer& scorer,
               const RobustOptions& options)
      : inner_(inner),
        problem_(problem),
        scorer_(scorer),
        max_squared_(options.MaxSquared(PairKind::k3d3d)),
        confidence_(options.confidence),
        random_(options.seed) {}

  /// Whether a triple of true pairs has been drawn with the wanted confidence within the budget,
  /// if the inliers of the best pose are the true pairs.
  bool Settles() {
    const auto count = static_cast<double>(scorer_.size());
    const double budget = std::max(kMinBudget, count * count * kBudgetShare);
    double wanted = budget;
    while (samples_ < wanted) {
      ++samples_;
      if (!DrawAgreeing() || !Improves()) continue;
      wanted = std::min(wanted, WantedSamples(scorer_.size(), inliers_.size(), 3, confidence_));
    }
    return samples_ < budget;
  }

  const Rigid3d& best() const { return best_; }
  int samples() const { return samples_; }

 private:
  // Beyond this budget the graph of all pairs is the better choice: a sample costs as much as 20 to
  // 50 entries of the graph.
  static constexpr double kMinBudget = 200.0;
  static constexpr double kBudgetShare = 1.0 / 200.0;
  // Rounds of least squares on the inliers; far fewer are needed.
  static constexpr int kMaxRounds = 20;

  // Draws three pairs; the third only where the first two agree, which outliers hardly ever do.
  bool DrawAgreeing() {
    const std::uint64_t bits = random_.Bits();
    const std::size_t a = IndexFrom(bits >> 32);
    const std::size_t b = IndexFrom(bits & 0xFFFFFFFFU);
    const PairColumns& pairs = scorer_.columns();
    if (a == b || !Agree(pairs, a, b, max_squared_)) return false;
    const std::size_t c = IndexFrom(random_.Bits() >> 32);
    if (c == a || c == b || !Agree(pairs, a, c, max_squared_) ||
        !Agree(pairs, b, c, max_squared_)) {
      return false;
    }
    triple_ = {static_cast<int>(a), static_cast<int>(b), static_cast<int>(c)};
    return true;
  }

  // From 32 random bits. The bias, at most one part in 10^5, does no harm here.
  std::size_t IndexFrom(std::uint64_t bits) const {
    return static_cast<std::size_t>((bits * scorer_.size()) >> 32);
  }

  // Takes those of the triple's poses that cost less than the best, after least squares.
  bool Improves() {
    bool improves = false;
    poses_.clear();
    inner_.Hypothesize(problem_, triple_, poses_);
    for (const Rigid3d& pose : poses_) {
      if (!(scorer_.Cost(pose, max_squared_) < best_cost_)) continue;
      best_ = OptimiseOnInliers(scorer_, pose, max_squared_, kMaxRounds, {});
      best_cost_ = scorer_.Cost(best_, max_squared_);
      scorer_.Inliers(best_, max_squared_, inliers_);
      improves = true;
    }
    return improves;
  }

  const Solver& inner_;
  const CalibrationProblem& problem_;
  ColumnScorer& scorer_;
  double max_squared_;
  double confidence_;
  Random random_;
  std::array<int, 3> triple_{};
  std::vector<Rigid3d> poses_;
  Rigid3d best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
  std::vector<int> inliers_;
  int samples_ = 0;
};

/// The fast solver for 3D-3D pairs with any share of outliers: a consensus search that costs little
/// where many pairs are true, and the maximum clique where the search does not settle.
///
/// Samples three pairs, which fix a pose, and continues only where their three lengths agree in
/// both frames (see clique); least squares on the inliers of each new best, in closed form. Ends
/// when three true pairs have been drawn with `confidence`. Where the graph of all pairs costs less
/// than that many samples, or a pair states a covariance, `clique` answers. The inner solver
/// answers on the inliers, chosen with a wider threshold where no false pair is expected within it
/// (FinalMaxSquared). Errors: those of clique.
class RobustSolver final : public Solver {
 public:
  RobustSolver(const SolverArguments& arguments, const RobustOptions& options, SolverPtr clique)
      : Solver({.name = arguments.name,
                .needs = clique->spec().needs,
                .estimates_rotation = clique->spec().estimates_rotation,
                .is_global = clique->spec().is_global}),
        inner_(arguments.inner),
        options_(options),
        clique_(std::move(clique)) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    return SolveWithNoise(problem, PairKind::k3d3d, options_, *inner_, options_.seed,
                          [this](const CalibrationProblem& stated) { return SolveStated(stated); });
  }

  // Requires pairs that state their noise.
  Expected<Estimate> SolveStated(const CalibrationProblem& problem) const {
    if (spec().estimates_rotation && AreIsotropic(problem.pairs_3d3d)) {
      ColumnScorer scorer(problem.pairs_3d3d);
      TripleSearch search(*inner_, problem, scorer, options_);
      if (search.Settles()) {
        Expected<Estimate> estimate = RefitOnInliers(*inner_, problem, scorer, search.best(),
                                                     options_.FinalMaxSquared(scorer));
        if (estimate && IsConsensus(problem, scorer, estimate->inliers)) {
          estimate->iterations = search.samples();
          estimate->termination = Termination::kConverged;
          return estimate;
        }
      }
    }
    return SolveWhole(*clique_, problem);
  }

  // If the points are mirrored, those near one plane agree on a pose, which is not the answer:
  // where only few pairs agree, clique decides.
  bool IsConsensus(const CalibrationProblem& problem, const PairScorer& scorer,
                   const std::vector<int>& inliers) const {
    const double max_squared = options_.MaxSquared(PairKind::k3d3d);
    if (!CheckConsensus(scorer, max_squared, inliers, spec().needs.pairs_3d3d)) return false;
    if (2 * inliers.size() >= scorer.size()) return true;
    const Expected<Estimate> estimate = SolveWhole(*inner_, problem);
    return estimate || estimate.error().code != ErrorCode::kMirrored;
  }

  SolverPtr inner_;
  RobustOptions options_;
  SolverPtr clique_;
};

OptionSet<RobustOptions> RobustOptionSet() {
  OptionSet<RobustOptions> options;
  options
      .Real("confidence", &RobustOptions::confidence, "1", 0.0, 1.0 - 1e-12,
            "probability of having drawn three true pairs when the sampling stops")
      .Count("seed", &RobustOptions::seed, 0, 1'000'000'000'000, "seed of the samples");
  return AddInlierOptions(options);
}

// The clique solver with the options that it shares.
Expected<SolverPtr> MakeClique(const SolverArguments& arguments) {
  SolverArguments shared = {.name = "clique", .options = {}, .inner = arguments.inner};
  for (const auto& [name, value] : arguments.options) {
    if (name != "confidence" && name != "seed") shared.options.emplace_back(name, value);
  }
  return CliqueEntry().make(shared);
}

}  // namespace

SolverEntry RobustEntry() {
  return {
      .name = "robust",
      .summary =
          "samples of pairs that agree on their lengths; clique where too few pairs are true",
      .needs = "one 3D-3D pair more than the inner solver needs; up to 95 percent outliers",
      .reference = "Fischler and Bolles 1981; Shi, Yang and Carlone 2021 (ROBIN)",
      .example = "robust(kabsch)",
      .wraps_solver = true,
      .options = RobustOptionSet().Describe(),
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        SEXTANT_ASSIGN_OR_RETURN(const RobustOptions options,
                                 RobustOptionSet().Parse(arguments.options));
        Expected<SolverPtr> clique = MakeClique(arguments);
        if (!clique) return clique;
        return std::make_shared<RobustSolver>(arguments, options, std::move(*clique));
      },
  };
}

}  // namespace sextant
