// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <limits>

#include "base/random.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/agreement_graph.h"
#include "solvers/kernels/pair_columns.h"
#include "solvers/robust/column_consensus.h"
#include "solvers/robust/consensus.h"
#include "solvers/robust/pair_scorer.h"

namespace sextant {

SolverEntry CliqueEntry();

namespace {

struct RobustOptions : InlierOptions {
  double confidence = 0.9999;
  std::uint64_t seed = 1;
};

/// Triples of pairs that agree on their lengths, the pose that most pairs follow, least squares on
/// these. Samples of outliers cost three comparisons: hardly any agrees.
class TripleSearch {
 public:
  TripleSearch(const Solver& inner, const CalibrationProblem& problem, const PairColumns& pairs,
               const RobustOptions& options)
      : inner_(inner),
        problem_(problem),
        pairs_(pairs),
        max_squared_(options.MaxSquared(PairKind::k3d3d)),
        confidence_(options.confidence),
        random_(options.seed) {}

  /// Whether a triple of true pairs has been drawn with the wanted confidence within the budget,
  /// were the pairs of the best pose all the true ones.
  bool Settles() {
    const auto count = static_cast<double>(pairs_.size());
    const double budget = std::max(kMinBudget, count * count * kBudgetShare);
    double wanted = budget;
    while (samples_ < wanted) {
      ++samples_;
      if (!DrawAgreeing() || !Improves()) continue;
      wanted = std::min(
          wanted, WantedSamples(pairs_.size(), static_cast<std::size_t>(inliers_), 3, confidence_));
    }
    return samples_ < budget;
  }

  const Rigid3d& best() const { return best_; }
  int samples() const { return samples_; }

 private:
  // Then the graph of all pairs is the better choice: a sample costs what 20 to 50 of its pairs
  // cost.
  static constexpr double kMinBudget = 200.0;
  static constexpr double kBudgetShare = 1.0 / 200.0;

  // Draws three pairs; the third only where the first two agree, which outliers hardly ever do.
  bool DrawAgreeing() {
    const std::uint64_t bits = random_.Bits();
    const std::size_t a = IndexFrom(bits >> 32);
    const std::size_t b = IndexFrom(bits & 0xFFFFFFFFU);
    if (a == b || !Agree(pairs_, a, b, max_squared_)) return false;
    const std::size_t c = IndexFrom(random_.Bits() >> 32);
    if (c == a || c == b || !Agree(pairs_, a, c, max_squared_) ||
        !Agree(pairs_, b, c, max_squared_)) {
      return false;
    }
    triple_ = {static_cast<int>(a), static_cast<int>(b), static_cast<int>(c)};
    return true;
  }

  // Of 32 random bits; the bias, a part in 10^5 at most, does no harm here.
  std::size_t IndexFrom(std::uint64_t bits) const {
    return static_cast<std::size_t>((bits * pairs_.size()) >> 32);
  }

  // Takes the triple's poses, each after least squares, where they cost less than the best.
  bool Improves() {
    bool improves = false;
    poses_.clear();
    inner_.Hypothesize(problem_, triple_, poses_);
    for (const Rigid3d& pose : poses_) {
      const double cost = TruncatedCost(pairs_, pose, max_squared_);
      if (!(cost < best_cost_)) continue;
      best_ = OptimiseOnInliers(pairs_, pose, max_squared_);
      const InlierFit fit = FitInliers(pairs_, best_, max_squared_);
      best_cost_ = fit.cost;
      inliers_ = fit.inliers;
      improves = true;
    }
    return improves;
  }

  const Solver& inner_;
  const CalibrationProblem& problem_;
  const PairColumns& pairs_;
  double max_squared_;
  double confidence_;
  Random random_;
  std::array<int, 3> triple_{};
  std::vector<Rigid3d> poses_;
  Rigid3d best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
  int inliers_ = 0;
  int samples_ = 0;
};

/// The fast way to 3D-3D pairs with any share of outliers: a consensus search that costs little
/// where many pairs are true, the maximum clique where it does not settle.
///
/// Samples three pairs, which fix a pose, and looks at them only where their three lengths agree
/// in both frames (see clique); least squares on the inliers of each new best, in closed form.
/// Ends when three true pairs have been drawn with `confidence`; where the graph of all pairs
/// costs less than that many samples, or the pairs state covariances, `clique` answers. The inner
/// solver has the last word on the inliers, with a wider threshold where no false pair is to be
/// feared within it. Errors: those of clique.
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
    if (spec().estimates_rotation && AreIsotropic(problem.pairs_3d3d)) {
      const PairColumns pairs(problem.pairs_3d3d, options_.Assumed());
      TripleSearch search(*inner_, problem, pairs, options_);
      if (search.Settles()) {
        const double max_squared = options_.FinalMaxSquared(
            pairs.size(), RandomAgreementProbability(pairs, kChiSquare3At9999));
        Expected<Estimate> estimate =
            RefitOnInliers(*inner_, problem, pairs, search.best(), max_squared);
        if (estimate && IsConsensus(problem, pairs, estimate->inliers)) {
          estimate->iterations = search.samples();
          estimate->termination = Termination::kConverged;
          return estimate;
        }
      }
    }
    return SolveWhole(*clique_, problem);
  }

  // Of mirrored points, those near one plane agree on a pose, which is not the answer: what few
  // follow is left to clique, which tells.
  bool IsConsensus(const CalibrationProblem& problem, const PairColumns& pairs,
                   const std::vector<int>& inliers) const {
    const double max_squared = options_.MaxSquared(PairKind::k3d3d);
    if (!CheckConsensus(pairs, max_squared, inliers, spec().needs.pairs_3d3d)) {
      return false;
    }
    if (2 * inliers.size() >= pairs.size()) return true;
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
      .Count("seed", &RobustOptions::seed, 0, 1'000'000'000'000, "of the samples");
  return AddInlierOptions(options);
}

// The clique solver with those of the options that it shares.
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
      .summary = "samples that agree on their lengths where many pairs are true, else the clique",
      .needs = "what the inner solver of 3D-3D pairs needs and one more; up to 95 percent outliers",
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
