// SPDX-License-Identifier: Apache-2.0
// The graph of pairs that agree, its cliques, and the solvers at 95 percent outliers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/agreement_graph.h"
#include "solvers/robust/clique_listing.h"
#include "solvers/robust/max_clique.h"
#include "support/outliers.h"

namespace sextant {
namespace {

using test::AddOutliers;
using test::MakeScene;
using test::Only;
using test::PairScene;
using test::SceneOptions;

BitGraph RandomGraph(int vertices, double density, Random& random) {
  BitGraph graph(vertices);
  for (int a = 0; a < vertices; ++a) {
    for (int b = 0; b < a; ++b) {
      const double draw = random.Uniform();
      if (draw < density) graph.Connect(a, b);
    }
  }
  return graph;
}

// All cliques of a small graph, to test the searches for exactness.
std::set<std::vector<int>> CliquesByBruteForce(const BitGraph& graph, std::size_t min_size) {
  std::set<std::vector<int>> cliques;
  for (unsigned subset = 0; subset < (1U << graph.vertices()); ++subset) {
    std::vector<int> members;
    for (int v = 0; v < graph.vertices(); ++v) {
      if ((subset >> v & 1U) != 0) members.push_back(v);
    }
    bool connected = members.size() >= min_size;
    for (std::size_t i = 0; connected && i < members.size(); ++i) {
      for (std::size_t j = 0; connected && j < i; ++j) {
        connected = graph.AreConnected(members[i], members[j]);
      }
    }
    if (connected) cliques.insert(members);
  }
  return cliques;
}

TEST(MaximumClique, IsTheLargestOfSmallGraphs) {
  Random random(9);
  for (int trial = 0; trial < 60; ++trial) {
    const double density = random.Uniform(0.1, 0.95);
    const BitGraph graph = RandomGraph(12, density, random);
    const Clique clique = FindMaximumClique(graph, 1'000'000);
    EXPECT_TRUE(clique.is_maximum);
    const std::set<std::vector<int>> cliques = CliquesByBruteForce(graph, 1);
    EXPECT_EQ(cliques.count(clique.vertices), 1U);
    for (const std::vector<int>& other : cliques) {
      EXPECT_LE(other.size(), clique.vertices.size());
    }
  }
}

TEST(MaximumClique, WithoutEdgesIsOneVertex) {
  EXPECT_EQ(FindMaximumClique(BitGraph(100), 1000).vertices.size(), 1U);
  EXPECT_TRUE(FindMaximumClique(BitGraph(0), 1000).vertices.empty());
}

TEST(ListCliques, ListsEachOnce) {
  Random random(10);
  for (int trial = 0; trial < 40; ++trial) {
    const double density = random.Uniform(0.1, 0.9);
    const BitGraph graph = RandomGraph(10, density, random);
    for (const std::size_t min_size : {1U, 3U, 4U}) {
      const std::set<std::vector<int>> expected = CliquesByBruteForce(graph, min_size);
      const std::vector<std::vector<int>> listed = ListCliques(graph, min_size, 100'000, 1'000'000);
      EXPECT_TRUE(std::equal(listed.begin(), listed.end(), expected.begin(), expected.end()));
    }
  }
}

TEST(ListCliques, StopsAtItsLimits) {
  Random random(11);
  const BitGraph complete = RandomGraph(100, 2.0, random);
  EXPECT_EQ(ListCliques(complete, 5, 7, 1'000'000).size(), 7U);
  EXPECT_LE(ListCliques(complete, 5, 1'000'000, 50).size(), 50U);
  EXPECT_TRUE(ListCliques(BitGraph(0), 1, 10, 10).empty());
}

// With counts around the width of a word, and noise that differs between pairs.
TEST(AgreementGraph, ConnectsPairsWhoseLengthsAgree) {
  constexpr double kMaxSquared = 9.0;
  for (const int count : {1, 2, 63, 64, 65, 128, 150}) {
    Random random(static_cast<std::uint64_t>(count));
    std::vector<Pair3d3d> pairs(static_cast<std::size_t>(count));
    for (Pair3d3d& pair : pairs) {
      for (double& x : pair.point_in_cam) x = random.Uniform(-1.0, 1.0);
      for (double& x : pair.point_in_lidar) x = random.Uniform(-1.0, 1.0);
      pair.sigma_m = random.Uniform(0.01, 0.1);
    }
    const PairColumns columns(pairs);
    const BitGraph graph = AgreementGraph(columns, kMaxSquared);
    std::vector<std::uint64_t> row(graph.words());
    for (int i = 0; i < count; ++i) {
      RowOfAgreements(columns, static_cast<std::size_t>(i), kMaxSquared, row);
      EXPECT_TRUE(std::equal(row.begin(), row.end(), graph.Row(i)));
      for (int j = 0; j < count; ++j) {
        const Pair3d3d& a = pairs[static_cast<std::size_t>(i)];
        const Pair3d3d& b = pairs[static_cast<std::size_t>(j)];
        const double excess =
            (a.point_in_cam - b.point_in_cam).norm() - (a.point_in_lidar - b.point_in_lidar).norm();
        const bool agree = std::abs(excess) <= 3.0 * std::hypot(a.sigma_m, b.sigma_m);
        EXPECT_EQ(graph.AreConnected(i, j), agree && i != j) << i << " " << j << " of " << count;
        EXPECT_EQ(
            Agree(columns, static_cast<std::size_t>(i), static_cast<std::size_t>(j), kMaxSquared),
            agree);
      }
    }
    // No bit beyond the last pair.
    for (std::size_t bit = static_cast<std::size_t>(count); bit < 64 * graph.words(); ++bit) {
      EXPECT_EQ(graph.Row(count - 1)[bit / 64] >> (bit % 64) & 1U, 0U);
    }
  }
}

class At95PercentOutliers : public testing::TestWithParam<const char*> {};

// With five true pairs the pose of four of them fits these four better than that of all five, and
// sometimes as many false ones agree. The solver must find every pose that the true pairs
// determine.
TEST_P(At95PercentOutliers, FindsAsManyPosesAsTheTruePairs) {
  const SceneOptions options{.pairs = 100, .sigma_m = 0.005};
  const SolverRegistry registry = BuiltinSolvers();
  const Expected<SolverPtr> solver = registry.Make(GetParam());
  const Expected<SolverPtr> oracle = registry.Make("kabsch");
  ASSERT_TRUE(solver && oracle);
  constexpr double kGood = 0.00873;  // Half a degree.
  int of_solver = 0;
  int of_oracle = 0;
  double squares = 0.0;
  double oracle_squares = 0.0;
  for (std::uint64_t trial = 0; trial < 300; ++trial) {
    Random random(DeriveSeed(1, "nineteen of twenty", 100, trial));
    PairScene scene = MakeScene(options, random);
    const std::vector<int> inliers = AddOutliers(0.95, options, random, scene);
    const Expected<SolveReport> report = (*solver)->Solve(scene.problem);
    const Expected<SolveReport> truth = (*oracle)->Solve(Only(scene.problem, inliers));
    const auto error = [&](const Expected<SolveReport>& r) {
      return r ? DistanceBetween(r->cam_from_lidar, scene.cam_from_lidar).rotation_rad : 3.14;
    };
    if (error(report) < kGood) ++of_solver;
    if (error(truth) >= kGood) continue;
    ++of_oracle;
    squares += error(report) * error(report);
    oracle_squares += error(truth) * error(truth);
  }
  EXPECT_GT(of_oracle, 200);
  EXPECT_GE(of_solver, of_oracle);
  EXPECT_LT(squares, 1.02 * oracle_squares);
}

INSTANTIATE_TEST_SUITE_P(Every, At95PercentOutliers,
                         testing::Values("clique(kabsch)", "robust(kabsch)"),
                         [](const auto& instance) {
                           return std::string(instance.param).substr(0, 6);
                         });

}  // namespace
}  // namespace sextant
