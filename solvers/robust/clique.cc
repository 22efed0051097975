// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "solvers/core/inner_solver.h"
#include "solvers/core/registry.h"
#include "solvers/robust/clique_listing.h"
#include "solvers/robust/max_clique.h"
#include "solvers/robust/pair_scorer.h"

namespace sextant {
namespace {

struct CliqueOptions : InlierOptions {
  std::int64_t max_nodes = 20'000;
};

// In a larger clique one false pair does little harm.
constexpr std::size_t kSmallClique = 16;
constexpr std::size_t kMaxCliques = 300;

// The graph, twice, takes 100 MB.
constexpr std::size_t kMaxPairs = 20'000;

/// The largest set of 3D-3D pairs that agree on all distances, then the inner solver on it.
///
/// A rigid motion keeps distances: true pairs i and j have | |c_i - c_j| - |l_i - l_j| | within
/// `threshold` of its sigma sqrt(u^T (S_i + S_j) u), u along c_i - c_j. Outliers agree with each
/// other by chance only, so the true pairs are the maximum clique of the graph of agreements even
/// at 95 percent outliers (Leordeanu and Hebert 2005; Shi, Yang and Carlone 2021, ROBIN). The inner
/// solver's pose then gathers its inliers anew, with FinalMaxSquared of the options, and the inner
/// solver answers on them unless least squares fits them better. Exact up to max_nodes nodes of the
/// search; after that the largest so far, and termination kMaxIterations. Memory N^2 / 8 bytes, and
/// as much again where hardly any pair is false; time N^2 to build. Errors: kNoConsensus (see
/// CheckConsensus), those of the inner solver.
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
    if (problem.pairs_3d3d.size() > kMaxPairs) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("{} pairs, expected at most {}: the graph would not fit; use "
                                   "ransac or gnc",
                                   problem.pairs_3d3d.size(), kMaxPairs));
    }
    const std::unique_ptr<PairScorer> judge = MakePairScorer(*inner_, problem, options_);
    const BitGraph graph = judge->Graph();
    const Clique clique = FindMaximumClique(graph, options_.max_nodes);
    const int least = spec().needs.pairs_3d3d;
    SEXTANT_RETURN_IF_ERROR(judge->Check(clique.vertices, least));
    SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose, PoseFrom(problem, *judge, graph, clique));
    Expected<Estimate> estimate = judge->Answer(pose);
    if (!estimate) return estimate;
    SEXTANT_RETURN_IF_ERROR(judge->Check(estimate->inliers, least));
    estimate->iterations = static_cast<int>(std::min<std::int64_t>(clique.nodes, 1'000'000'000));
    estimate->termination =
        clique.is_maximum ? Termination::kConverged : Termination::kMaxIterations;
    return estimate;
  }

  // Distances do not tell a point from its mirror image: a false pair may have taken the place of
  // a true one, and as many of chance may agree. So where there are few, all cliques count that are
  // as large or lack one, and the cheapest pose is taken.
  Expected<Rigid3d> PoseFrom(const CalibrationProblem& problem, const PairScorer& judge,
                             const BitGraph& graph, const Clique& clique) const {
    std::vector<std::vector<int>> cliques;
    if (clique.vertices.size() <= kSmallClique) {
      const auto fewest = static_cast<std::size_t>(MinPairs(inner_->spec().needs));
      cliques = ListCliques(graph, std::max(clique.vertices.size() - 1, fewest), kMaxCliques,
                            options_.max_nodes);
    }
    // The first, should there be more than are listed.
    cliques.insert(cliques.begin(), clique.vertices);
    std::vector<ScoredPose> poses;
    for (const std::vector<int>& vertices : cliques) AddPoses(problem, judge, vertices, poses);
    if (poses.empty()) return WhyNoPose(problem, clique);
    return BestOptimised(judge, std::move(poses));
  }

  struct ScoredPose {
    double cost;
    Rigid3d pose;
  };

  void AddPoses(const CalibrationProblem& problem, const PairScorer& judge,
                std::span<const int> vertices, std::vector<ScoredPose>& judged) const {
    std::vector<Rigid3d> poses;
    inner_->Hypothesize(problem, vertices, poses);
    for (const Rigid3d& pose : poses) judged.push_back({judge.Cost(pose), pose});
  }

  // Of the most promising.
  Rigid3d BestOptimised(const PairScorer& judge, std::vector<ScoredPose> poses) const {
    constexpr std::size_t kMaxOptimised = 3;
    const std::size_t optimised = std::min(kMaxOptimised, poses.size());
    const auto is_cheaper = [](const ScoredPose& a, const ScoredPose& b) {
      return a.cost < b.cost;
    };
    std::stable_sort(poses.begin(), poses.end(), is_cheaper);
    if (!spec().estimates_rotation) return poses.front().pose;
    poses.resize(optimised);
    for (ScoredPose& judged : poses) {
      judged.pose = judge.Optimise(judged.pose);
      judged.cost = judge.Cost(judged.pose);
    }
    return std::min_element(poses.begin(), poses.end(), is_cheaper)->pose;
  }

  // The inner solver's reason where most pairs agree on their distances.
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
                "of the search tree; after them the largest clique so far is taken");
  return AddInlierOptions(options);
}

}  // namespace

SolverEntry CliqueEntry() {
  return {
      .name = "clique",
      .summary = "the largest set of pairs that agree on all distances, the inner solver on it",
      .needs = "what the inner solver of 3D-3D pairs needs and one more; up to 95 percent outliers",
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
