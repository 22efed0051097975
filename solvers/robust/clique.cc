// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "solvers/core/inner_solver.h"
#include "solvers/core/registry.h"
#include "solvers/robust/clique_listing.h"
#include "solvers/robust/consensus.h"
#include "solvers/robust/max_clique.h"
#include "solvers/robust/noise_scale.h"

namespace sextant {
namespace {

struct CliqueOptions : InlierOptions {
  std::int64_t max_nodes = 20'000;
};

// One false pair in a larger clique does little harm.
constexpr std::size_t kSmallClique = 16;
constexpr std::size_t kMaxCliques = 300;

// Two graphs of this size take 100 MB.
constexpr std::size_t kMaxPairs = 20'000;

/// The largest set of 3D-3D pairs that agree on all distances, then the inner solver on it.
///
/// A rigid motion keeps distances: true pairs i and j have | |c_i - c_j| - |l_i - l_j| | within
/// `threshold` of its sigma sqrt(u^T (S_i + S_j) u), u along c_i - c_j. Outliers agree with each
/// other by chance only, so the true pairs are the maximum clique of the graph of agreements even
/// at 95 percent outliers (Leordeanu and Hebert 2005; Shi, Yang and Carlone 2021, ROBIN). The
/// inliers are then chosen again by the pose, within FinalMaxSquared of the options; the inner
/// solver answers on them unless least squares fits them better. Exact up to max_nodes nodes of the
/// search; beyond that the largest clique so far, with termination kMaxIterations. Memory N^2 / 8
/// bytes, and as much again where hardly any pair is false; time N^2 to build. Errors: kNoConsensus
/// (see CheckConsensus), those of the inner solver.
class CliqueSolver final : public Solver {
 public:
  CliqueSolver(const SolverArguments& arguments, const CliqueOptions& options)
      : Solver({.name = arguments.name,
                .needs = NeedsOfConsensus(arguments.inner->spec().needs, PairKind::k3d3d),
                .estimates_rotation = arguments.inner->spec().estimates_rotation,
                .is_global = arguments.inner->spec().is_global}),
        inner_(arguments.inner),
        options_(options) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    return SolveWithNoise(problem, PairKind::k3d3d, options_, *inner_, kScaleSeed,
                          [this](const CalibrationProblem& stated) { return SolveStated(stated); });
  }

  // Requires pairs that state their noise.
  Expected<Estimate> SolveStated(const CalibrationProblem& problem) const {
    if (problem.pairs_3d3d.size() > kMaxPairs) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("{} pairs, expected at most {}: the graph would not fit; use "
                                   "ransac or gnc",
                                   problem.pairs_3d3d.size(), kMaxPairs));
    }
    const std::unique_ptr<PairScorer> scorer = MakePairScorer(problem, PairKind::k3d3d);
    const double max_squared = options_.MaxSquared(PairKind::k3d3d);
    const BitGraph graph = scorer->AgreementGraph(max_squared);
    const Clique clique = FindMaximumClique(graph, options_.max_nodes);
    const int min_inliers = spec().needs.pairs_3d3d;
    SEXTANT_RETURN_IF_ERROR(CheckConsensus(*scorer, max_squared, clique.vertices, min_inliers));
    const double final_max_squared = options_.FinalMaxSquared(*scorer);
    SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose,
                             BestPose(problem, *scorer, final_max_squared, graph, clique));
    Expected<Estimate> estimate =
        BetterOnInliers(*inner_, problem, *scorer, pose, final_max_squared);
    if (!estimate) return estimate;
    SEXTANT_RETURN_IF_ERROR(CheckConsensus(*scorer, estimate->cam_from_lidar, max_squared,
                                           estimate->inliers, min_inliers));
    estimate->iterations = static_cast<int>(std::min<std::int64_t>(clique.nodes, 1'000'000'000));
    estimate->termination =
        clique.is_maximum ? Termination::kConverged : Termination::kMaxIterations;
    return estimate;
  }

  // Distances do not distinguish a point from its mirror image, so a false pair may have taken the
  // place of a true one, or an equally large set may agree by chance. Where the clique is small,
  // all cliques that are as large or one smaller count, and the cheapest pose is taken.
  Expected<Rigid3d> BestPose(const CalibrationProblem& problem, PairScorer& scorer,
                             double max_squared, const BitGraph& graph,
                             const Clique& clique) const {
    std::vector<std::vector<int>> cliques;
    if (clique.vertices.size() <= kSmallClique) {
      const auto min_pairs = static_cast<std::size_t>(MinPairs(inner_->spec().needs));
      cliques = ListCliques(graph, std::max(clique.vertices.size() - 1, min_pairs), kMaxCliques,
                            options_.max_nodes);
    }
    // The list may be cut off before this one.
    cliques.insert(cliques.begin(), clique.vertices);
    std::vector<ScoredPose> candidates;
    std::vector<Rigid3d> poses;
    for (const std::vector<int>& vertices : cliques) {
      poses.clear();
      inner_->Hypothesize(problem, vertices, poses);
      for (const Rigid3d& pose : poses)
        candidates.push_back({scorer.Cost(pose, max_squared), pose});
    }
    if (candidates.empty()) return WhyNoPose(problem, clique);
    return BestOptimised(scorer, max_squared, std::move(candidates));
  }

  struct ScoredPose {
    double cost;
    Rigid3d pose;
  };

  // The best of the cheapest poses after least squares on their inliers.
  Rigid3d BestOptimised(PairScorer& scorer, double max_squared,
                        std::vector<ScoredPose> candidates) const {
    constexpr std::size_t kMaxOptimised = 3;
    constexpr int kMaxRounds = 20;  // Far fewer are needed.
    const auto is_cheaper = [](const ScoredPose& a, const ScoredPose& b) {
      return a.cost < b.cost;
    };
    std::stable_sort(candidates.begin(), candidates.end(), is_cheaper);
    if (!spec().estimates_rotation) return candidates.front().pose;
    candidates.resize(std::min(kMaxOptimised, candidates.size()));
    for (ScoredPose& candidate : candidates) {
      candidate.pose = OptimiseOnInliers(scorer, candidate.pose, max_squared, kMaxRounds, {});
      candidate.cost = scorer.Cost(candidate.pose, max_squared);
    }
    return std::min_element(candidates.begin(), candidates.end(), is_cheaper)->pose;
  }

  // The error of the inner solver where most pairs agree on their distances.
  Expected<Rigid3d> WhyNoPose(const CalibrationProblem& problem, const Clique& clique) const {
    if (2 * clique.vertices.size() > problem.pairs_3d3d.size()) {
      return SolveSubset(*inner_, problem, clique.vertices).map([](const Estimate& estimate) {
        return estimate.cam_from_lidar;
      });
    }
    return MakeError(ErrorCode::kNoConsensus,
                     fmt::format("at most {} of {} pairs agree on their distances, and on no pose; "
                                 "check the pairing and the sigmas",
                                 clique.vertices.size(), problem.pairs_3d3d.size()));
  }

  SolverPtr inner_;
  CliqueOptions options_;
};

OptionSet<CliqueOptions> CliqueOptionSet() {
  OptionSet<CliqueOptions> options;
  options.Count("max_nodes", &CliqueOptions::max_nodes, 1, 1'000'000'000'000,
                "maximum nodes of the search tree, (1000/N)^2 of them for more than 1000 pairs; "
                "after them the largest clique so far is taken");
  return AddInlierOptions(options);
}

}  // namespace

SolverEntry CliqueEntry() {
  return {
      .name = "clique",
      .summary = "the inner solver on the largest set of pairs that agree on all distances",
      .needs = "one 3D-3D pair more than the inner solver needs; up to 95 percent outliers",
      .reference = "Shi, Yang and Carlone 2021 (ROBIN); Tomita and Seki 2003",
      .example = "clique(kabsch)",
      .wraps_solver = true,
      .options = CliqueOptionSet().Describe(),
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        SEXTANT_ASSIGN_OR_RETURN(const CliqueOptions options,
                                 CliqueOptionSet().Parse(arguments.options));
        SEXTANT_ASSIGN_OR_RETURN(const PairKind kind, KindOfPairs(*arguments.inner, "clique"));
        if (kind != PairKind::k3d3d) {
          return MakeError(
              ErrorCode::kInvalidOption,
              fmt::format(
                  "clique: '{}' works on pixels, which have no distances; expected a solver "
                  "of 3D-3D pairs such as kabsch, or use ransac",
                  arguments.inner->spec().name));
        }
        return std::make_shared<CliqueSolver>(arguments, options);
      },
  };
}

}  // namespace sextant
