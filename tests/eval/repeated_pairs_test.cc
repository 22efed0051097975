// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/repeated_pairs.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <random>

#include "eval/diagnostics/facing.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

CalibrationProblem PixelPairs() {
  CalibrationProblem problem;
  for (int i = 0; i < 6; ++i) {
    problem.pairs_2d3d.push_back({.pixel = {100.0 * i, 40.0 * i * i},
                                  .point_in_lidar = {0.3 * i, 2.0, 0.1 * i * i},
                                  .sigma_px = 0.0,
                                  .id = {.view = 0, .board = i, .corner = 0}});
  }
  return problem;
}

TEST(RepeatedPairs, CopiesCountOnce) {
  CalibrationProblem problem = PixelPairs();
  for (const int i : {0, 0, 4}) {
    problem.pairs_2d3d.push_back(problem.pairs_2d3d[static_cast<std::size_t>(i)]);
  }
  const std::vector<RepeatedPairs> found = MergeRepeatedPairs(problem);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].in_pixels);
  ASSERT_EQ(problem.pairs_2d3d.size(), 6U);
  for (int i = 0; i < 6; ++i)
    EXPECT_EQ(problem.pairs_2d3d[static_cast<std::size_t>(i)].id.board, i);
  const std::vector<std::string> lines = Describe(found[0]);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_THAT(lines[0], HasSubstr("3 pairs repeat others"));
  EXPECT_THAT(lines[0], HasSubstr("7 of 1, 8 of 1, 9 of 5"));
}

// Two rows of noisy points that rounded to one LiDAR point are not wrong.
TEST(RepeatedPairs, NoiseIsNoContradiction) {
  CalibrationProblem problem = PixelPairs();
  problem.pairs_2d3d.push_back(problem.pairs_2d3d[4]);
  problem.pairs_2d3d.back().pixel.x() += 60.0;
  const std::vector<RepeatedPairs> found = MergeRepeatedPairs(problem);
  ASSERT_EQ(found.size(), 1U);
  ASSERT_EQ(found[0].contradictory.size(), 1U);
  EXPECT_THAT(Describe(found[0]), testing::ElementsAre(HasSubstr("one of them is wrong")));
  EXPECT_THAT(Describe(found[0], 4.0), testing::ElementsAre(HasSubstr("one of them is wrong")));
  EXPECT_THAT(Describe(found[0], 20.0), testing::ElementsAre(HasSubstr("the noise of the pairs")));
}

TEST(RepeatedPairs, ObservationsThatAgreeAreAveraged) {
  CalibrationProblem problem = PixelPairs();
  problem.pairs_2d3d.push_back(problem.pairs_2d3d[2]);
  problem.pairs_2d3d.push_back(problem.pairs_2d3d[2]);
  problem.pairs_2d3d[6].pixel.x() += 3.0;
  problem.pairs_2d3d[7].pixel.x() += 1.5;
  EXPECT_EQ(MergeRepeatedPairs(problem).at(0).merged.size(), 2U);
  EXPECT_NEAR(problem.pairs_2d3d[2].pixel.x(), 201.5, 1e-12);
}

// One copy of every pair, rounded differently: sigma must not shrink.
TEST(RepeatedPairs, CopiesMayDifferByRounding) {
  CalibrationProblem problem = PixelPairs();
  for (int i = 0; i < 6; ++i) {
    Pair2d3d copy = problem.pairs_2d3d[static_cast<std::size_t>(i)];
    copy.point_in_lidar += 2e-5 * Eigen::Vector3d(i % 2, -1.0, 1.0);
    copy.pixel += Eigen::Vector2d(0.01, -0.02);
    problem.pairs_2d3d.push_back(copy);
  }
  EXPECT_EQ(MergeRepeatedPairs(problem).at(0).merged.size(), 6U);
  EXPECT_EQ(problem.pairs_2d3d.size(), 6U);
  // A millimetre apart they are neighbours.
  problem.pairs_2d3d.push_back(problem.pairs_2d3d[3]);
  problem.pairs_2d3d.back().point_in_lidar.z() += 1e-3;
  EXPECT_THAT(MergeRepeatedPairs(problem), IsEmpty());
}

TEST(RepeatedPairs, ContradictionsAreNamedAndRemain) {
  CalibrationProblem problem = PixelPairs();
  problem.pairs_2d3d.push_back(problem.pairs_2d3d[1]);
  problem.pairs_2d3d.back().pixel += Eigen::Vector2d(0.0, 300.0);
  const std::vector<RepeatedPairs> found = MergeRepeatedPairs(problem);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(problem.pairs_2d3d.size(), 7U);
  EXPECT_THAT(Describe(found[0]).at(0),
              HasSubstr("pairs 2 and 7 have the same LiDAR point, but are 300 px apart"));
  CalibrationProblem distinct = PixelPairs();
  EXPECT_THAT(MergeRepeatedPairs(distinct), IsEmpty());
}

TEST(RepeatedPairs, PointsAreMergedInTheUnpairedSetsToo) {
  CalibrationProblem problem;
  for (int i = 0; i < 4; ++i) {
    problem.pairs_3d3d.push_back({.point_in_cam = {0.5 * i, 0.2 * i * i, 2.0},
                                  .point_in_lidar = {2.0, -0.5 * i, -0.2 * i * i},
                                  .sigma_m = 0.01,
                                  .covariance_in_cam = {},
                                  .id = {}});
  }
  problem.pairs_3d3d.push_back(problem.pairs_3d3d[3]);
  problem.pairs_3d3d.back().point_in_cam.z() += 0.02;
  EXPECT_EQ(MergeRepeatedPairs(problem).at(0).merged.size(), 1U);
  EXPECT_EQ(problem.pairs_3d3d.size(), 4U);
  EXPECT_EQ(problem.point_sets.in_cam.size(), 4U);
}

class Scene {
 public:
  explicit Scene(unsigned seed) : random_(seed) {}

  double Normal(double sigma) { return sigma * std::normal_distribution<double>()(random_); }
  Eigen::Vector3d Noise(double sigma) { return {Normal(sigma), Normal(sigma), Normal(sigma)}; }

  // Corners of boards of `size` [m], measured by both sensors with an error of `noise` [m].
  std::vector<Pair3d3d> Corners(int boards, double size, double noise) {
    std::uniform_real_distribution<double> within(-1.0, 1.0);
    const Eigen::Quaterniond lidar_from_cam(0.5, 0.5, -0.5, 0.5);
    std::vector<Pair3d3d> pairs;
    for (int b = 0; b < boards; ++b) {
      const Eigen::Vector3d centre(2.0 * within(random_), within(random_), 4.0 + within(random_));
      const Eigen::Quaterniond turn(
          Eigen::AngleAxisd(0.5, Eigen::Vector3d(Noise(1.0)).normalized()));
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector3d corner(k % 2 == 0 ? size : 0.0, k < 2 ? size : 0.0, 0.0);
        const Eigen::Vector3d in_cam = centre + turn * corner;
        pairs.push_back({.point_in_cam = in_cam + Noise(noise),
                         .point_in_lidar = lidar_from_cam * in_cam + Noise(noise),
                         .sigma_m = 0.0,
                         .covariance_in_cam = {},
                         .id = {.view = 0, .board = b, .corner = k}});
      }
    }
    return pairs;
  }

  std::vector<Pair3d3d> Repeated(const std::vector<Pair3d3d>& pairs, int times, double jitter) {
    std::vector<Pair3d3d> all;
    for (int i = 0; i < times; ++i) {
      for (Pair3d3d pair : pairs) {
        pair.point_in_cam += Noise(jitter);
        pair.point_in_lidar += Noise(jitter);
        pair.id = {.view = 0, .board = static_cast<int>(all.size()), .corner = 0};
        all.push_back(pair);
      }
    }
    return all;
  }

 private:
  std::mt19937 random_;
};

std::vector<Pair2d3d> InPixels(const std::vector<Pair3d3d>& pairs) {
  std::vector<Pair2d3d> seen;
  for (const Pair3d3d& pair : pairs) {
    seen.push_back({.pixel = 1000.0 * pair.point_in_cam.hnormalized(),
                    .point_in_lidar = pair.point_in_lidar,
                    .sigma_px = 0.0,
                    .id = pair.id});
  }
  return seen;
}

// A scene at rest, recorded ten times: its points count once, whatever the jitter.
TEST(RepeatedPairs, ASceneMeasuredSeveralTimesCountsOnce) {
  for (const double jitter : {1e-5, 1e-4, 3e-4, 1e-3, 3e-3}) {
    Scene scene(11);
    const std::vector<Pair3d3d> once = scene.Corners(3, 0.5, 0.01);
    CalibrationProblem problem;
    problem.pairs_3d3d = scene.Repeated(once, 10, jitter);
    problem.pairs_2d3d = InPixels(scene.Repeated(once, 10, jitter));
    const std::vector<RepeatedPairs> found = MergeRepeatedPairs(problem);
    ASSERT_EQ(found.size(), 2U) << jitter;
    ASSERT_EQ(problem.pairs_3d3d.size(), 12U) << jitter;
    ASSERT_EQ(problem.pairs_2d3d.size(), 12U) << jitter;
    EXPECT_EQ(problem.point_sets.in_cam.size(), 12U);
    for (std::size_t i = 0; i < once.size(); ++i) {
      const Pair3d3d& mean = problem.pairs_3d3d[i];
      EXPECT_LT((mean.point_in_cam - once[i].point_in_cam).norm(), 2.0 * jitter);
      EXPECT_LT((mean.point_in_lidar - once[i].point_in_lidar).norm(), 2.0 * jitter);
    }
    EXPECT_THAT(Describe(found[0]).at(0), HasSubstr("120 pairs were merged into 12"));
    EXPECT_EQ(PlaceInFile(11, false, found), 12);
  }
}

// Each small board is a tight group far from the others, and yet its corners are four points.
TEST(RepeatedPairs, CornersOfSmallBoardsFarApartRemain) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    Scene scene(seed);
    CalibrationProblem problem;
    problem.pairs_3d3d = scene.Corners(6, 0.05, 0.003);
    problem.pairs_2d3d = InPixels(problem.pairs_3d3d);
    EXPECT_THAT(MergeRepeatedPairs(problem), IsEmpty()) << seed;
  }
}

// A hand moved the board by two centimetres: both sensors saw it, so that the pairs are new.
TEST(RepeatedPairs, PairsOfABoardThatMovedALittleRemain) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    Scene scene(seed);
    const std::vector<Pair3d3d> still = scene.Corners(3, 0.5, 0.0);
    CalibrationProblem problem;
    for (int view = 0; view < 5; ++view) {
      for (Pair3d3d pair : still) {
        const Eigen::Vector3d moved = scene.Noise(0.02);
        const Eigen::Quaterniond lidar_from_cam(0.5, 0.5, -0.5, 0.5);
        pair.point_in_cam += moved + scene.Noise(0.003);
        pair.point_in_lidar += lidar_from_cam * moved + scene.Noise(0.003);
        pair.id.view = view;
        problem.pairs_3d3d.push_back(pair);
      }
    }
    EXPECT_THAT(MergeRepeatedPairs(problem), IsEmpty()) << seed;
  }
}

TEST(Facing, TellsOppositeSidesOfABoardFromTheSame) {
  const std::vector<Eigen::Vector3d> board = {
      {3.0, 0.5, 0.5}, {3.0, -0.5, 0.5}, {3.0, -0.5, -0.5}, {3.0, 0.5, -0.5}};
  const std::vector<std::vector<Eigen::Vector3d>> boards = {board};
  const auto camera_at = [](double x) { return Rigid3d{{1.0, 0.0, 0.0, 0.0}, {-x, 0.0, 0.0}}; };
  EXPECT_FALSE(SensorsFaceEachOther(boards, camera_at(0.2)));
  EXPECT_TRUE(SensorsFaceEachOther(boards, camera_at(6.0)));
  EXPECT_FALSE(SensorsFaceEachOther(boards, camera_at(3.01)));  // In the plane.
  EXPECT_FALSE(SensorsFaceEachOther({}, camera_at(6.0)));
}

// Points that happen to lie near a plane between the sensors, which both see at 2 degrees.
TEST(Facing, IsNotSeenInPlanesThatBothSensorsSeeEdgeOn) {
  const std::vector<std::vector<Eigen::Vector3d>> groups = {
      {{3.5, 0.1, -0.5}, {4.5, 0.1, -0.5}, {4.5, 0.1, 0.5}, {3.5, 0.1, 0.5}}};
  EXPECT_FALSE(SensorsFaceEachOther(groups, Rigid3d{{1.0, 0.0, 0.0, 0.0}, {0.0, -0.3, 0.0}}));
}

// The same board seen at 17 degrees from both sides, once exact and once with a noise that turns
// its normal by as much.
TEST(Facing, IsNotSeenWhereNoiseMayTurnTheBoardSoFar) {
  const auto board = [](double noise) {
    return std::vector<std::vector<Eigen::Vector3d>>{{{3.5, 1.2 + noise, -0.5},
                                                      {4.5, 1.2 - noise, -0.5},
                                                      {4.5, 1.2 + noise, 0.5},
                                                      {3.5, 1.2 - noise, 0.5}}};
  };
  const Rigid3d opposite{{1.0, 0.0, 0.0, 0.0}, {0.0, -2.4, 0.0}};
  EXPECT_TRUE(SensorsFaceEachOther(board(0.0), opposite));
  EXPECT_FALSE(SensorsFaceEachOther(board(0.06), opposite));
}

}  // namespace
}  // namespace sextant
