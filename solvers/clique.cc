// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/consensus.h"
#include "solvers/max_clique.h"
#include "solvers/pair_columns.h"
#include "solvers/pair_noise.h"
#include "solvers/registry.h"
#include "solvers/subset.h"

namespace sextant {
namespace {

struct CliqueOptions : InlierOptions {
  std::int64_t max_nodes = 20'000;
};

// Of least squares on the inliers; far fewer are needed.
constexpr int kMaxRounds = 20;

// In a larger clique one false pair does little harm.
constexpr std::size_t kSmallClique = 16;

// The graph, twice, takes 100 MB.
constexpr std::size_t kMostPairs = 20'000;

/// The largest set of 3D-3D pairs that agree on all distances, then the inner solver on it.
///
/// A rigid motion keeps distances: true pairs i and j have | |c_i - c_j| - |l_i - l_j| | within
/// `threshold` of its sigma sqrt(u^T (S_i + S_j) u), u along c_i - c_j. Outliers agree with each
/// other by chance only, so the true pairs are the maximum clique of the graph of agreements even
/// at 95 percent outliers (Leordeanu and Hebert 2005; Shi, Yang and Carlone 2021, ROBIN). The inner
/// solver's pose then gathers its inliers anew, and the inner solver answers on them unless least
/// squares fits them better. Exact up to max_nodes nodes of the search; after
/// that the largest so far, and termination kMaxIterations. Memory N^2 / 4 bytes, time N^2 to
/// build. Errors: kNoConsensus (see CheckConsensus), those of the inner solver.
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
    if (problem.pairs_3d3d.size() > kMostPairs) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("{} pairs, expected at most {}: the graph would not fit; use "
                                   "ransac or gnc",
                                   problem.pairs_3d3d.size(), kMostPairs));
    }
    const PairTerms terms = MakeTerms(problem, PairKind::k3d3d, options_.Assumed());
    const PoseScorer scorer(terms, options_.MaxSquared(PairKind::k3d3d));
    const BitGraph graph = GraphOf(problem.pairs_3d3d);
    const Clique clique = FindMaximumClique(graph, options_.max_nodes);
    const int least = spec().needs.pairs_3d3d;
    if (Expected<void> ok = CheckConsensus(terms, scorer, clique.vertices, least); !ok) {
      return tl::unexpected<Error>(std::move(ok.error()));
    }
    Expected<Rigid3d> pose = PoseFrom(problem, terms, scorer, clique);
    if (clique.vertices.size() <= kSmallClique) {
      pose = BestWithoutOne(problem, terms, scorer, graph, clique, std::move(pose));
    }
    if (!pose) return tl::unexpected<Error>(std::move(pose.error()));
    Expected<Estimate> estimate = BetterOnInliers(*inner_, problem, terms, scorer, *pose);
    if (!estimate) return estimate;
    if (Expected<void> ok = CheckConsensus(terms, scorer, estimate->inliers, least); !ok) {
      return tl::unexpected<Error>(std::move(ok.error()));
    }
    estimate->iterations = static_cast<int>(std::min<std::int64_t>(clique.nodes, 1'000'000'000));
    estimate->termination =
        clique.is_maximum ? Termination::kConverged : Termination::kMaxIterations;
    return estimate;
  }

  // The pose of the clique, then of all pairs within its threshold.
  Expected<Rigid3d> PoseFrom(const CalibrationProblem& problem, const PairTerms& terms,
                             const PoseScorer& scorer, const Clique& clique) const {
    Expected<Rigid3d> pose = PoseOfSubset(*inner_, problem, terms, clique.vertices);
    if (!pose || !spec().estimates_rotation) return pose;
    InlierWorkspace workspace;
    return OptimiseOnInliers(terms, scorer, *pose, kMaxRounds, {}, workspace);
  }

  // Distances do not tell a point from its mirror image: a false pair may have taken the place of
  // a true one. So each is left out in turn, and the best pose counts.
  Expected<Rigid3d> BestWithoutOne(const CalibrationProblem& problem, const PairTerms& terms,
                                   const PoseScorer& scorer, const BitGraph& graph,
                                   const Clique& clique, Expected<Rigid3d> best) const {
    double least_cost = best ? scorer.Cost(*best) : std::numeric_limits<double>::infinity();
    for (const int suspect : clique.vertices) {
      BitGraph without = graph;
      without.Isolate(suspect);
      const Clique other = FindMaximumClique(without, options_.max_nodes);
      if (static_cast<int>(other.vertices.size()) < LeastPairs(inner_->spec().needs)) continue;
      Expected<Rigid3d> pose = PoseFrom(problem, terms, scorer, other);
      const double cost = pose ? scorer.Cost(*pose) : std::numeric_limits<double>::infinity();
      if (!(cost < least_cost)) continue;
      least_cost = cost;
      best = std::move(pose);
    }
    if (best || 2 * clique.vertices.size() > problem.pairs_3d3d.size()) return best;
    return MakeError(ErrorCode::kNoConsensus,
                     fmt::format("at most {} of {} pairs agree on their distances, and on no pose; "
                                 "check the pairing and the sigmas",
                                 clique.vertices.size(), problem.pairs_3d3d.size()));
  }

  BitGraph GraphOf(const std::vector<Pair3d3d>& pairs) const {
    const double max_squared = options_.MaxSquared(PairKind::k3d3d);
    if (std::none_of(pairs.begin(), pairs.end(),
                     [](const Pair3d3d& pair) { return pair.covariance_in_cam.has_value(); })) {
      return AgreementGraph(PairColumns(pairs, options_.Assumed()), max_squared);
    }
    std::vector<Eigen::Matrix3d> noise;
    noise.reserve(pairs.size());
    for (const Pair3d3d& pair : pairs) {
      noise.push_back(HasKnownNoise(pair) ? StatedCovariance(pair)
                                          : Eigen::Matrix3d(Eigen::Matrix3d::Identity() *
                                                            options_.sigma_m * options_.sigma_m));
    }
    BitGraph graph(static_cast<int>(pairs.size()));
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const Eigen::Vector3d in_cam = pairs[i].point_in_cam - pairs[j].point_in_cam;
        const double lidar_length = (pairs[i].point_in_lidar - pairs[j].point_in_lidar).norm();
        const double cam_squared = in_cam.squaredNorm();
        const double excess = std::sqrt(cam_squared) - lidar_length;
        // excess^2 <= max_squared u^T S u, without the division by |c|^2.
        const double spread = in_cam.dot((noise[i] + noise[j]) * in_cam);
        if (excess * excess * cam_squared <= max_squared * spread) {
          graph.Connect(static_cast<int>(i), static_cast<int>(j));
        }
      }
    }
    return graph;
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
        const Expected<CliqueOptions> options = CliqueOptionSet().Parse(arguments.options);
        if (!options) return tl::unexpected<Error>(options.error());
        const Expected<PairKind> kind = KindOfPairs(*arguments.inner, "clique");
        if (!kind) return tl::unexpected<Error>(kind.error());
        if (*kind != PairKind::k3d3d) {
          return MakeError(
              ErrorCode::kInvalidOption,
              fmt::format(
                  "clique: '{}' works on pixels, which have no distances; expected a solver "
                  "of 3D-3D pairs such as kabsch, or use ransac",
                  arguments.inner->spec().name));
        }
        return std::make_shared<CliqueSolver>(arguments, *options);
      },
  };
}

}  // namespace sextant
