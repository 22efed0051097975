// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/random.h"
#include "solvers/consensus.h"
#include "solvers/pair_columns.h"
#include "solvers/registry.h"

namespace sextant {

SolverEntry CliqueEntry();

namespace {

struct RobustOptions : InlierOptions {
  double confidence = 0.9999;
  std::uint64_t seed = 1;
};

constexpr int kMaxRefits = 10;

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
    const double budget = std::max(kLeastBudget, count * count * kBudgetShare);
    double wanted = budget;
    while (samples_ < wanted) {
      ++samples_;
      if (DrawAgreeing() && Improves()) wanted = std::min(wanted, WantedSamples());
    }
    return samples_ < budget;
  }

  const Rigid3d& best() const { return best_; }
  int samples() const { return samples_; }

 private:
  // A sample costs what 50 pairs cost in the graph of all pairs, which then is the better choice.
  static constexpr double kLeastBudget = 1000.0;
  static constexpr double kBudgetShare = 1.0 / 50.0;

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

  double WantedSamples() const {
    const auto n = static_cast<double>(pairs_.size());
    const auto k = static_cast<double>(inliers_);
    const double all_true = k * (k - 1.0) * (k - 2.0) / (n * (n - 1.0) * (n - 2.0));
    if (all_true >= 1.0) return 1.0;
    return std::ceil(std::log1p(-confidence_) / std::log1p(-all_true));
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
        Expected<Estimate> estimate = Refit(problem, pairs, search.best());
        if (estimate && IsConsensus(problem, pairs, estimate->inliers)) {
          estimate->iterations = search.samples();
          estimate->termination = Termination::kConverged;
          return estimate;
        }
      }
    }
    std::vector<int> all(problem.pairs_3d3d.size());
    std::iota(all.begin(), all.end(), 0);
    return SolveSubset(*clique_, problem, all);
  }

  static bool AreIsotropic(const std::vector<Pair3d3d>& pairs) {
    return std::none_of(pairs.begin(), pairs.end(),
                        [](const Pair3d3d& pair) { return pair.covariance_in_cam.has_value(); });
  }

  // Leaving out one true pair in a hundred costs two percent of accuracy. Where even the wider
  // threshold lets in no false pair, as the chance of one tells, it is taken in the end.
  double FinalMaxSquared(const PairColumns& pairs) const {
    constexpr double kChiSquare3At9999 = 21.107513466204896;
    constexpr double kMostFalsePairs = 0.05;
    if (options_.threshold > 0.0) return options_.MaxSquared(PairKind::k3d3d);
    const double false_pairs =
        static_cast<double>(pairs.size()) * ChanceOfAgreement(pairs, kChiSquare3At9999);
    return false_pairs < kMostFalsePairs ? kChiSquare3At9999 : options_.MaxSquared(PairKind::k3d3d);
  }

  // RefitOnInliers in columns.
  Expected<Estimate> Refit(const CalibrationProblem& problem, const PairColumns& pairs,
                           const Rigid3d& pose) const {
    const double max_squared = FinalMaxSquared(pairs);
    std::vector<int> inliers = InliersOf(pairs, pose, max_squared);
    for (int refit = 0;; ++refit) {
      if (static_cast<int>(inliers.size()) < spec().needs.pairs_3d3d) {
        return MakeError(ErrorCode::kNoConsensus, "too few pairs follow the pose");
      }
      Expected<Estimate> estimate = SolveSubset(*inner_, problem, inliers);
      if (!estimate) return estimate;
      std::vector<int> next = InliersOf(pairs, estimate->cam_from_lidar, max_squared);
      if (next == inliers || refit + 1 == kMaxRefits) return estimate;
      inliers = std::move(next);
    }
  }

  // Of mirrored points, those near one plane agree on a pose, which is not the answer: what few
  // follow is left to clique, which tells.
  bool IsConsensus(const CalibrationProblem& problem, const PairColumns& pairs,
                   const std::vector<int>& inliers) const {
    const double chance = ChanceOfAgreement(pairs, options_.MaxSquared(PairKind::k3d3d));
    if (!IsBeyondChance(PairKind::k3d3d, LeastDistinct(pairs, inliers),
                        static_cast<int>(pairs.size()), chance)) {
      return false;
    }
    if (2 * inliers.size() >= pairs.size()) return true;
    std::vector<int> all(pairs.size());
    std::iota(all.begin(), all.end(), 0);
    const Expected<Estimate> estimate = SolveSubset(*inner_, problem, all);
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
        const Expected<RobustOptions> options = RobustOptionSet().Parse(arguments.options);
        if (!options) return tl::unexpected<Error>(options.error());
        Expected<SolverPtr> clique = MakeClique(arguments);
        if (!clique) return clique;
        return std::make_shared<RobustSolver>(arguments, *options, std::move(*clique));
      },
  };
}

}  // namespace sextant
