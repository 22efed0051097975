// SPDX-License-Identifier: Apache-2.0
// Half of the pairs belong to another pose: whatever is solved, this is said, with both poses.
#include "eval/diagnostics/rival_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "base/random.h"
#include "eval/metrics/default_specs.h"
#include "eval/synthetic/random_scene.h"
#include "geometry/so3.h"
#include "solvers/builtin_solvers.h"

namespace sextant {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kMovedSeeds = 10;
constexpr int kMinMovedFound = 9;

/// A scene of which the camera moved before the second half of the pairs.
struct MovedScene {
  CalibrationProblem problem;
  Rigid3d first;
  Rigid3d second;
};

MovedScene Moved(int pairs, bool in_pixels, std::uint64_t seed) {
  Random random(DeriveSeed(1, "moved", static_cast<std::uint64_t>(pairs), seed));
  RandomScene scene = MakeRandomScene(
      {.pairs = pairs, .sigma_m = 0.01, .sigma_px = 1.0, .states_noise = false}, random);
  const Rigid3d move{ExpSo3({0.06, -0.04, 0.03}), {0.3, -0.2, 0.1}};
  MovedScene moved{{}, scene.cam_from_lidar, move * scene.cam_from_lidar};
  moved.problem.camera = scene.problem.camera;
  for (std::size_t i = 0; i < static_cast<std::size_t>(pairs); ++i) {
    const bool is_second = 2 * i >= static_cast<std::size_t>(pairs);
    if (in_pixels) {
      Pair2d3d pair = scene.problem.pairs_2d3d[i];
      const Eigen::Vector3d in_cam = moved.second * pair.point_in_lidar;
      const Eigen::Vector2d noise(random.Normal(), random.Normal());
      if (is_second) pair.pixel = *Project(*moved.problem.camera, in_cam) + noise;
      moved.problem.pairs_2d3d.push_back(pair);
    } else {
      Pair3d3d pair = scene.problem.pairs_3d3d[i];
      if (is_second) pair.point_in_cam = move * pair.point_in_cam;
      moved.problem.pairs_3d3d.push_back(pair);
    }
  }
  return moved;
}

bool AreNear(const Rigid3d& a, const Rigid3d& b) {
  const PoseDistance distance = DistanceBetween(a, b);
  return distance.translation_m < 0.12 && distance.rotation_rad < 0.04;
}

class RivalGroupsTest : public testing::TestWithParam<std::tuple<int, bool>> {};

TEST_P(RivalGroupsTest, AreFoundAndBothPosesReported) {
  const auto& [pairs, in_pixels] = GetParam();
  const SolverRegistry registry = BuiltinSolvers();
  int found = 0;
  for (std::uint64_t seed = 1; seed <= kMovedSeeds; ++seed) {
    const MovedScene scene = Moved(pairs, in_pixels, seed);
    const auto rivals = FindRivalGroups(registry, scene.problem);
    if (!rivals) continue;  // So many pairs of the other group fit by chance that it is no rival.
    ++found;
    const Rigid3d& larger = rivals->groups[0].cam_from_lidar;
    const Rigid3d& smaller = rivals->groups[1].cam_from_lidar;
    EXPECT_TRUE((AreNear(larger, scene.first) && AreNear(smaller, scene.second)) ||
                (AreNear(larger, scene.second) && AreNear(smaller, scene.first)))
        << "seed " << seed;
    EXPECT_THAT(Describe(*rivals, {}), HasSubstr("contradict each other"));
    const std::string spec = DefaultSpec(registry, scene.problem);
    EXPECT_EQ(spec, in_pixels ? "refine(ransac(p3p))" : "robust(kabsch)");
    const auto report = (*registry.Make(spec))->Solve(scene.problem);
    ASSERT_TRUE(report) << report.error().message;
    const bool is_first = AreNear(report->cam_from_lidar, scene.first);
    EXPECT_TRUE(is_first || AreNear(report->cam_from_lidar, scene.second)) << "seed " << seed;
    const Rigid3d& other = is_first ? scene.second : scene.first;
    EXPECT_TRUE(std::ranges::any_of(report->alternatives,
                                    [&](const Rigid3d& pose) { return AreNear(pose, other); }))
        << "seed " << seed;
  }
  EXPECT_GE(found, kMinMovedFound);
}

INSTANTIATE_TEST_SUITE_P(Every, RivalGroupsTest,
                         testing::Values(std::tuple(10, false), std::tuple(20, false),
                                         std::tuple(60, false), std::tuple(20, true),
                                         std::tuple(60, true)));

// Four pixels each, which any of several poses explains.
TEST(RivalGroups, AreNotFoundInEightPixels) {
  const SolverRegistry registry = BuiltinSolvers();
  for (std::uint64_t seed = 1; seed <= kMovedSeeds; ++seed) {
    EXPECT_FALSE(FindRivalGroups(registry, Moved(8, true, seed).problem)) << seed;
  }
}

// No robust solver keeps all pairs under the compromise. It may refuse them instead, except the two
// that AreFoundAndBothPosesReported rests on for the same pairs.
TEST(RivalGroups, AreNoConsensusOfAllPairs) {
  const SolverRegistry registry = BuiltinSolvers();
  std::map<std::string, int> answers;
  for (std::uint64_t seed = 1; seed <= kMovedSeeds; ++seed) {
    const MovedScene scene = Moved(10, false, seed);
    for (const char* spec : {"ransac(kabsch)", "robust(kabsch)", "clique(kabsch)", "gnc(kabsch)"}) {
      const auto report = (*registry.Make(spec))->Solve(scene.problem);
      if (!report) continue;
      ++answers[spec];
      EXPECT_TRUE(AreNear(report->cam_from_lidar, scene.first) ||
                  AreNear(report->cam_from_lidar, scene.second))
          << spec << ", seed " << seed;
      EXPECT_EQ(report->alternatives.size(), 1U) << spec << ", seed " << seed;
    }
  }
  EXPECT_GE(answers["ransac(kabsch)"], kMinMovedFound);
  EXPECT_GE(answers["robust(kabsch)"], kMinMovedFound);
}

// A sigma that is stated three times too small is no second pose.
TEST(RivalGroups, AreNotFoundWhereTheStatedNoiseIsTooSmall) {
  const SolverRegistry registry = BuiltinSolvers();
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(DeriveSeed(3, "too small a sigma", 0, seed));
    RandomScene scene = MakeRandomScene(
        {.pairs = 8 + static_cast<int>(seed), .sigma_m = 0.02, .sigma_px = 2.0}, random);
    for (Pair3d3d& pair : scene.problem.pairs_3d3d) pair.sigma_m /= 3.0;
    for (Pair2d3d& pair : scene.problem.pairs_2d3d) pair.sigma_px /= 3.0;
    EXPECT_FALSE(FindRivalGroups(registry, scene.problem)) << seed;
    scene.problem.pairs_3d3d.clear();
    EXPECT_FALSE(FindRivalGroups(registry, scene.problem)) << seed;
  }
}

TEST(RivalGroups, AreNotFoundInPairsOfOnePose) {
  const SolverRegistry registry = BuiltinSolvers();
  // One scene in a hundred has a pair that looks like an outlier.
  constexpr int kMaxRobust = 6;
  int robust = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    for (const bool on_boards : {false, true}) {
      Random random(DeriveSeed(2, "one pose", 0, seed));
      RandomScene scene = MakeRandomScene({.pairs = 16,
                                           .sigma_m = 0.01,
                                           .sigma_px = 1.0,
                                           .on_boards = on_boards,
                                           .shared_error = on_boards ? 1.0 : 0.0,
                                           .states_noise = false},
                                          random);
      EXPECT_FALSE(FindRivalGroups(registry, scene.problem)) << seed;
      robust += DefaultSpec(registry, scene.problem) != "kabsch" ? 1 : 0;
      scene.problem.pairs_3d3d.clear();
      EXPECT_FALSE(FindRivalGroups(registry, scene.problem)) << seed;
      robust += DefaultSpec(registry, scene.problem) != "refine(sqpnp)" ? 1 : 0;
    }
  }
  EXPECT_LE(robust, kMaxRobust);
}

}  // namespace
}  // namespace sextant
