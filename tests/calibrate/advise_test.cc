// SPDX-License-Identifier: Apache-2.0
#include "calibrate/advise/advise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "base/units.h"
#include "calibrate/advise/advise_rig.h"
#include "calibrate/trust/information.h"
#include "eval/metrics/bounds.h"
#include "eval/synthetic/simulate_rig.h"
#include "eval/synthetic/simulate_views.h"
#include "solvers/joint/board_view_information.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Steps of the LiDAR along its rings: what SimulateViews has by default, and fewer returns where
// their number does not matter.
constexpr double kFineStep_deg = 0.2;
constexpr double kCoarseStep_deg = 0.6;

// The LiDAR of SimulateViews.
LidarPattern SimulatedLidar(double step_deg) {
  LidarPattern lidar{.azimuth_step_rad = step_deg * kRadPerDeg, .range_sigma_m = 0.01};
  for (int ring = 0; ring < 16; ++ring) {
    lidar.elevations_rad.push_back((2.0 * ring - 15.0) * kRadPerDeg);
  }
  return lidar;
}

SimulatedViews Simulate(int views, std::uint64_t seed, double step_deg = kCoarseStep_deg) {
  const Expected<SimulatedViews> session =
      SimulateViews({.seed = seed, .views = views, .azimuth_step_deg = step_deg, .exact = true});
  EXPECT_TRUE(session) << session.error().message;
  return *session;
}

SensorPair SensorsOf(const SimulatedViews& session, double step_deg = kCoarseStep_deg) {
  return {.camera = *session.problem.camera,
          .lidar = SimulatedLidar(step_deg),
          .cam_from_lidar = session.true_cam_from_lidar};
}

// The result of a perfect calibration with the first views of a session.
CalibrationResult ResultOf(const SimulatedViews& session, int views) {
  CalibrationResult result;
  result.camera = session.problem.camera;
  result.boards = session.problem.boards;
  result.cam_from_lidar = session.true_cam_from_lidar;
  for (int view = 0; view < views; ++view) {
    ResultView& entry = result.views.emplace_back();
    entry.view = view;
    entry.boards.push_back(
        {.board = 0,
         .cam_from_board = session.true_cam_from_board[static_cast<std::size_t>(view)]});
  }
  AddInformation(session.problem, result);
  return result;
}

Eigen::VectorXd RatiosOf(const Matrix6d& a, const Matrix6d& b) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d>(a, b, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

// Rings begin at random azimuths there, so a return more or less on each ring is all the
// difference.
TEST(PredictView, TellsTheInformationOfTheSimulatedView) {
  int seen = 0;
  constexpr int kViews = 40;
  const SimulatedViews session = Simulate(kViews, 3, kFineStep_deg);
  const SensorPair sensors = SensorsOf(session, kFineStep_deg);
  for (std::size_t i = 0; i < kViews; ++i) {
    const Rigid3d& pose = session.true_cam_from_board[i];
    std::optional<BoardView> view = PredictView(sensors, session.problem.boards[0], pose);
    if (!view) continue;
    ++seen;
    const BoardView& simulated = session.problem.board_views[i];
    EXPECT_NEAR(static_cast<double>(view->edges.size()),
                static_cast<double>(simulated.edges.size()), 2.0);
    for (EdgeRay& edge : view->edges) edge.sigma_m = simulated.edges[0].sigma_m;
    const auto of = [&](const BoardView& v) {
      return *InformationOfView(v, session.problem.boards[0], sensors.camera,
                                sensors.cam_from_lidar, pose);
    };
    const Eigen::VectorXd ratios = RatiosOf(of(*view), of(simulated));
    EXPECT_GT(ratios.minCoeff(), 0.75) << i;
    EXPECT_LT(ratios.maxCoeff(), 1.33) << i;
  }
  EXPECT_GT(seen, kViews * 9 / 10);
}

TEST(PredictView, RefusesWhatASensorWouldNotFind) {
  const SimulatedViews session = Simulate(1, 1, kFineStep_deg);
  const SensorPair sensors = SensorsOf(session, kFineStep_deg);
  const Board& board = session.problem.boards[0];
  const auto at = [&](double turn_deg, const Eigen::Vector3d& where) {
    const Eigen::Quaterniond corner_up = ExpSo3({0.0, 0.0, 45.0 * kRadPerDeg});
    return PredictView(sensors, board,
                       {ExpSo3({0.0, turn_deg * kRadPerDeg, 0.0}) * corner_up, where})
        .has_value();
  };
  EXPECT_TRUE(at(0.0, {0.0, 0.0, 2.0}));
  EXPECT_FALSE(at(0.0, {0.0, 0.0, -2.0}));   // Behind both.
  EXPECT_FALSE(at(180.0, {0.0, 0.0, 2.0}));  // Its back.
  EXPECT_FALSE(at(75.0, {0.0, 0.0, 2.0}));   // Nearly edge-on.
  EXPECT_FALSE(at(0.0, {3.0, 0.0, 2.0}));    // Beside the image.
  EXPECT_FALSE(at(0.0, {0.0, 0.0, 20.0}));   // One ring at most.
}

TEST(Advise, ShrinksTheCovarianceMoreThanARandomPose) {
  constexpr int kSessions = 4;
  double ratios = 0.0;
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= kSessions; ++seed) {
    const SimulatedViews session = Simulate(4, seed);
    const SensorPair sensors = SensorsOf(session);
    const CalibrationResult two = ResultOf(session, 2);
    const Expected<Advice> advice = Advise(two, sensors);
    ASSERT_TRUE(advice) << advice.error().message;
    ASSERT_TRUE(advice->covariance);
    EXPECT_EQ(advice->views, 2);
    EXPECT_LT(advice->proposal.covariance.determinant(), advice->covariance->determinant());
    // Two views drawn at random, each alone besides the two.
    for (const std::size_t random : {2U, 3U}) {
      const auto view =
          PredictView(sensors, session.problem.boards[0], session.true_cam_from_board[random]);
      if (!view) continue;
      const Matrix6d information =
          advice->covariance->inverse() + *InformationOfView(*view, session.problem.boards[0],
                                                             sensors.camera, sensors.cam_from_lidar,
                                                             session.true_cam_from_board[random]);
      const Matrix6d with_random = *CovarianceOf(information);
      EXPECT_LT(advice->proposal.covariance.determinant(), with_random.determinant()) << seed;
      ratios += RmsOf(advice->proposal.covariance).translation_m / RmsOf(with_random).translation_m;
      ++compared;
    }
  }
  ASSERT_GE(compared, kSessions);
  EXPECT_LT(ratios / compared, 0.9);
  RecordProperty("sigma_of_advised_over_random", std::to_string(ratios / compared));
}

TEST(Advise, WithoutStoredInformationItIsForeseenFromThePoses) {
  const SimulatedViews session = Simulate(3, 5);
  const SensorPair sensors = SensorsOf(session);
  const CalibrationResult stored = ResultOf(session, 3);
  CalibrationResult bare = stored;
  for (ResultView& view : bare.views) view.information.reset();
  const Advice by_file = *Advise(stored, sensors);
  const Advice by_poses = *Advise(bare, sensors);
  EXPECT_EQ(by_poses.views, 3);
  const Vector6d ratio =
      by_poses.covariance->diagonal().cwiseQuotient(by_file.covariance->diagonal());
  EXPECT_LT(ratio.maxCoeff(), 4.0);
  EXPECT_GT(ratio.minCoeff(), 0.25);
}

TEST(Advise, BeginsFromNothing) {
  const SimulatedViews session = Simulate(1, 5);
  CalibrationResult result = ResultOf(session, 0);
  const Expected<Advice> advice = Advise(result, SensorsOf(session));
  ASSERT_TRUE(advice) << advice.error().message;
  EXPECT_FALSE(advice->covariance);
  EXPECT_GE(advice->proposal.rings, 4);
  EXPECT_GT(advice->considered, 100);
}

// What is known may not determine the pose; it must not be counted as the proposal's own.
TEST(Advise, TheInformationOfTheProposalIsItsOwn) {
  const SimulatedViews session = Simulate(2, 5);
  CalibrationResult result = ResultOf(session, 1);
  const Expected<Advice> alone = Advise(ResultOf(session, 0), SensorsOf(session));
  ASSERT_TRUE(alone) << alone.error().message;
  EXPECT_TRUE(alone->proposal.information.isApprox(alone->proposal.covariance.inverse(), 1e-6));
  constexpr double kKnown = 1e12;
  Matrix6d one_direction = Matrix6d::Zero();
  one_direction(0, 0) = kKnown;
  result.views[0].information = one_direction;
  const Expected<Advice> advice = Advise(result, SensorsOf(session));
  ASSERT_TRUE(advice) << advice.error().message;
  EXPECT_FALSE(advice->covariance);
  EXPECT_LT(advice->proposal.information(0, 0), 0.01 * kKnown);
  EXPECT_LT(advice->proposal.covariance(0, 0), 2.0 / kKnown);
}

TEST(Advise, NamesTheMissingInput) {
  const SimulatedViews session = Simulate(1, 5);
  CalibrationResult result = ResultOf(session, 1);
  SensorPair sensors = SensorsOf(session);
  sensors.lidar.elevations_rad = {0.0};
  const auto message = [&] {
    const Expected<Advice> advice = Advise(result, sensors);
    return advice ? std::string("advised") : advice.error().message;
  };
  EXPECT_THAT(message(), HasSubstr("nowhere from 1.2 to 5 m would both sensors see a board"));
  sensors.lidar.elevations_rad.clear();
  EXPECT_THAT(message(), HasSubstr("rings, azimuth step and range noise are not known"));
  sensors = SensorsOf(session);
  sensors.camera.width_px = 0;
  EXPECT_THAT(message(), HasSubstr("image size is not known"));
  result.boards.clear();
  EXPECT_THAT(message(), HasSubstr("has no boards"));
}

TEST(AddInformation, PredictsTheBoundOfAllViewsAfterTheLast) {
  const SimulatedViews session = Simulate(5, 9);
  const CalibrationResult result = ResultOf(session, 5);
  const Expected<Matrix6d> bound = CramerRaoBoundOfViews(
      session.problem, session.true_cam_from_lidar, session.true_cam_from_board);
  ASSERT_TRUE(bound);
  const Vector6d ratio = result.views[4].sigma_so_far->cwiseQuotient(bound->diagonal().cwiseSqrt());
  EXPECT_NEAR(ratio.maxCoeff(), 1.0, 1e-3);
  EXPECT_NEAR(ratio.minCoeff(), 1.0, 1e-3);
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_TRUE((*result.views[i].sigma_so_far - *result.views[i - 1].sigma_so_far).maxCoeff() <
                1e-12);
  }
}

TEST(WeakestOf, NamesDirectionsAsAPersonAtTheCameraWould) {
  Matrix6d covariance = Matrix6d::Identity() * 1e-8;
  covariance(4, 4) = 25e-6;
  covariance(2, 2) = std::pow(0.2 * kRadPerDeg, 2);
  EXPECT_EQ(DescribeWeakest(WeakestOf(covariance)),
            "translation down-up 5 mm, rotation about forward 0.2 deg");
  EXPECT_EQ(AxisName(Eigen::Vector3d(1, 1, 0).normalized()), "(0.71, 0.71, 0.00)");
}

// The words on its sides and its top are true of its corners.
TEST(DescribePlacement, SidesAndTopAreAsSaid) {
  const Board board{.id = 4, .top_right_m = 0.5, .right_bottom_m = 0.5};
  const auto turned = [](double turn_deg, double lean_deg) {
    return Rigid3d{
        ExpSo3({0.0, turn_deg * kRadPerDeg, 0.0}) * ExpSo3({lean_deg * kRadPerDeg, 0.0, 0.0}),
        {-0.42, 0.31, 1.8}};
  };
  const auto depth = [](const Rigid3d& pose, double x, double y) {
    return (pose * Eigen::Vector3d(x, y, 0.0)).z();
  };
  const Rigid3d right_near = turned(30.0, 0.0);
  EXPECT_LT(depth(right_near, 0.25, 0.0), depth(right_near, -0.25, 0.0));
  EXPECT_EQ(DescribePlacement(board, right_near),
            "Hold board 4 1.8 m in front of the camera, 0.4 m to its left and 0.3 m below it, with "
            "one corner up, turned so that its left side is farther away by 30 deg.");
  const Rigid3d top_near = turned(0.0, 20.0);
  EXPECT_LT(depth(top_near, 0.0, -0.25), depth(top_near, 0.0, 0.25));
  EXPECT_THAT(DescribePlacement(board, top_near),
              HasSubstr("its top leaning towards the camera by 20 deg"));
  EXPECT_THAT(DescribePlacement(board, turned(-25.0, -10.0)),
              HasSubstr("right side is farther away by 25 deg, its top leaning away from"));
  EXPECT_THAT(DescribePlacement(board, {Eigen::Quaterniond::Identity(), {0.0, 0.01, 2.0}}),
              HasSubstr("straight ahead and at its height, with one corner up, facing the camera"));
}

TEST(DegenerateSets, EachIsNamedAndASpreadSetIsNot) {
  const auto pose = [](double turn_deg, double x, double z) {
    return Rigid3d{ExpSo3({0.0, turn_deg * kRadPerDeg, 0.0}), {x, 0.0, z}};
  };
  EXPECT_THAT(DegenerateSets({pose(0, 0, 2)}), IsEmpty());
  EXPECT_THAT(DegenerateSets({pose(0, -0.8, 1.5), pose(30, 0.8, 3.0)}), IsEmpty());
  const auto parallel = DegenerateSets({pose(0, -0.8, 1.5), pose(4, 0.8, 3.0)});
  ASSERT_THAT(parallel, SizeIs(1));
  EXPECT_THAT(parallel[0], HasSubstr("all boards are parallel to within 4 deg"));
  const auto one_range = DegenerateSets({pose(0, -0.8, 2.0), pose(30, 0.8, 2.0)});
  ASSERT_THAT(one_range, SizeIs(1));
  EXPECT_THAT(one_range[0], HasSubstr("at one range"));
  EXPECT_THAT(DegenerateSets({pose(0, 0.0, 2.0), pose(0, 0.1, 2.0)}), SizeIs(3));
}

TEST(AdviseRig, NamesTheWeakestPairAndABoardThatHelpsIt) {
  // The last LiDAR sees the board in three moments only.
  const SimulatedRig simulated = SimulateRig({.cameras = 2, .lidars = 2, .moments = 10});
  RigFile rig{.problem = simulated.problem};
  constexpr std::size_t kRare = 3;
  for (std::size_t i = 3; i < rig.problem.placements.size(); ++i) {
    std::erase_if(rig.problem.placements[i].seen,
                  [](const RigObservation& seen) { return seen.sensor == kRare; });
  }
  const auto advice = AdviseRig(rig);
  ASSERT_TRUE(advice) << advice.error().message;
  EXPECT_EQ(advice->weakest.b, "lidar_1");
  EXPECT_LE(advice->weakest.views, 3);
  EXPECT_THAT(advice->seen_by, testing::Contains("lidar_1"));
  EXPECT_THAT(advice->sentence, HasSubstr("in front of cam_"));
  // One more board of as much information as each of three: about 3/4 of the variance.
  const double before = advice->weakest.a_from_b.covariance.trace();
  EXPECT_LT(advice->covariance.trace(), 0.9 * before);
  EXPECT_GT(advice->covariance.trace(), 0.2 * before);
}

TEST(AdviseRig, ASensorWithoutAPoseIsNamedWithWhatWouldConnectIt) {
  const SimulatedRig simulated = SimulateRig({.cameras = 1, .lidars = 2, .moments = 5});
  RigFile rig{.problem = simulated.problem};
  for (RigPlacement& placement : rig.problem.placements) {
    std::erase_if(placement.seen, [](const RigObservation& seen) { return seen.sensor == 2; });
  }
  const auto advice = AdviseRig(rig);
  ASSERT_FALSE(advice);
  EXPECT_THAT(advice.error().message, HasSubstr("'lidar_1' shares no view"));
}

}  // namespace
}  // namespace sextant
