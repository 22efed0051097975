// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "base/random.h"
#include "eval/synthetic/simulate_rig.h"
#include "eval/synthetic/simulate_views.h"
#include "geometry/symmetric.h"
#include "solvers/blocks/pose_manifold.h"
#include "solvers/builtin_solvers.h"
#include "solvers/rig/rig_costs.h"
#include "solvers/rig/solve_rig.h"

namespace sextant {
namespace {

using testing::HasSubstr;

/// Squared errors of every pair of sensors over many rigs.
struct PairErrors {
  double nees = 0.0;        ///< Sum of e' C^-1 e / 6.
  double over_bound = 0.0;  ///< Sum of the squared error over the bound's, per axis.
  int count = 0;
};

Matrix6d BoundOf(const RigEstimate& estimate, const Eigen::MatrixXd& bound, std::size_t a,
                 std::size_t b) {
  RigEstimate at_truth = estimate;
  at_truth.covariance = bound;
  return at_truth.Between(a, b).covariance;
}

std::vector<Rigid3d> FromFirst(const SimulatedRig& rig) {
  std::vector<Rigid3d> poses;
  for (std::size_t s = 0; s < rig.sensor_from_rig.size(); ++s) {
    poses.push_back(rig.TrueBetween(s, 0));
  }
  return poses;
}

std::vector<Rigid3d> BoardsInFirst(const SimulatedRig& rig) {
  std::vector<Rigid3d> poses;
  for (const Rigid3d& board : rig.rig_from_board) poses.push_back(rig.sensor_from_rig[0] * board);
  return poses;
}

// Adds the errors of all pairs of one rig.
void Add(const SimulatedRig& rig, const RigEstimate& estimate, const Eigen::MatrixXd& bound,
         PairErrors& errors) {
  for (std::size_t a = 0; a < rig.sensor_from_rig.size(); ++a) {
    for (std::size_t b = a + 1; b < rig.sensor_from_rig.size(); ++b) {
      const UncertainPose pose = estimate.Between(a, b);
      const Vector6d error = PoseDifference(pose.b_from_a, rig.TrueBetween(a, b));
      errors.nees += SquaredMahalanobis<6>(error, pose.covariance) / 6.0;
      errors.over_bound += SquaredMahalanobis<6>(error, BoundOf(estimate, bound, a, b)) / 6.0;
      ++errors.count;
    }
  }
}

// A third of the returns of the default, for the time.
constexpr double kCoarseAzimuth_deg = 0.6;

PairErrors ErrorsOver(RigSimulation simulation, int rigs) {
  simulation.sensors.azimuth_step_deg = kCoarseAzimuth_deg;
  PairErrors errors;
  for (int i = 0; i < rigs; ++i) {
    simulation.seed = static_cast<std::uint64_t>(100 + i);
    const SimulatedRig rig = SimulateRig(simulation);
    const auto estimate = SolveRig(rig.problem);
    EXPECT_TRUE(estimate) << estimate.error().message;
    if (!estimate) continue;
    EXPECT_TRUE(estimate->unconnected.empty());
    const auto bound = RigBound(rig.problem, 0, FromFirst(rig), BoardsInFirst(rig));
    EXPECT_TRUE(bound);
    if (bound) Add(rig, *estimate, *bound, errors);
  }
  return errors;
}

TEST(Rig, ExactObservationsOfCamerasAndLidarsGiveTheTruth) {
  RigSimulation simulation{.cameras = 2, .lidars = 2, .moments = 5};
  simulation.sensors.exact = true;
  const SimulatedRig rig = SimulateRig(simulation);
  const auto estimate = SolveRig(rig.problem);
  ASSERT_TRUE(estimate) << estimate.error().message;
  for (std::size_t s = 0; s < rig.sensor_from_rig.size(); ++s) {
    const auto off = DistanceBetween(*estimate->sensor_from_root[s], rig.TrueBetween(s, 0));
    EXPECT_LT(off.translation_m, 1e-6) << rig.problem.sensors[s].name;
    EXPECT_LT(off.rotation_rad, 1e-6) << rig.problem.sensors[s].name;
  }
  EXPECT_TRUE(estimate->warnings.empty());
}

// A print behind the camera at the current poses is left out, and does not end the search.
TEST(RigBlockCost, IsNotEvaluatedWhereNothingOfTheBlockIsUsed) {
  RigBlock block{.units = 2};
  bool is_evaluated = false;
  block.residuals = [&](const Rigid3d&, RigResiduals&) {
    is_evaluated = true;
    return false;
  };
  RigPlacementModel placement;
  placement.shift_of = {-1};
  std::vector<double> weights = {0.0, 0.0};
  const RigBlockCost cost(block, placement, weights);
  const std::array<double, kPoseNumbers> pose = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0};
  const double* const parameters[] = {pose.data(), pose.data()};
  Eigen::Vector2d residuals = Eigen::Vector2d::Ones();
  Eigen::Matrix<double, 2, kPoseNumbers, Eigen::RowMajor> by_sensor;
  by_sensor.setOnes();
  double* jacobians[] = {by_sensor.data(), nullptr};
  EXPECT_TRUE(cost.Evaluate(parameters, residuals.data(), jacobians));
  EXPECT_FALSE(is_evaluated);
  EXPECT_TRUE(residuals.isZero());
  EXPECT_TRUE(by_sensor.isZero());
  weights[1] = 1.0;
  EXPECT_FALSE(cost.Evaluate(parameters, residuals.data(), nullptr));
}

// Rays past the rim of a round hole are assigned to its points by the pose of the board that the
// observation states; its raw view has none.
TEST(RigModel, EdgeRaysOfRimsHaveNoResidualsAtTheTruth) {
  const Rigid3d lidar_from_board{
      Eigen::Quaterniond(Eigen::Matrix3d{{0.0, 0.0, 1.0}, {-1.0, 0.0, 0.0}, {0.0, -1.0, 0.0}}),
      {4.0, 0.3, -0.2}};
  Board board{.id = 1, .top_right_m = 1.0, .right_bottom_m = 0.8};
  board.round_holes = {{.radius_m = 0.12, .center_in_board_m = {0.25, -0.15}}};
  RigObservation seen{.sensor = 0, .sensor_from_board = lidar_from_board};
  for (int k = 0; k < 12; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 12;
    const Eigen::Vector2d rim =
        board.round_holes[0].center_in_board_m +
        board.round_holes[0].radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const Eigen::Vector3d in_lidar = lidar_from_board * Eigen::Vector3d(rim.x(), rim.y(), 0.0);
    seen.raw.edges.push_back(
        {.direction = in_lidar.normalized(), .side = kFirstRim, .sigma_m = 0.01});
  }
  RigProblem problem;
  problem.sensors = {{.name = "lidar", .lidar_errors = kWhiteNoiseOnly}};
  problem.boards = {board};
  problem.placements = {{.moment = 0, .board = 1, .seen = {seen}}};
  const RigModel model = RigModelOf(problem);
  ASSERT_EQ(model.blocks.size(), 1U);
  RigResiduals residuals;
  ASSERT_TRUE(model.blocks[0].residuals(lidar_from_board, residuals));
  EXPECT_LT(residuals.value.cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Rig, ErrorsAreThoseOfTheBoundAndOfTheCovariance) {
  RigSimulation simulation{.cameras = 2, .lidars = 2, .moments = 8, .takes_part = 0.8};
  const PairErrors errors = ErrorsOver(simulation, 14);
  EXPECT_GT(errors.nees / errors.count, 0.8);
  EXPECT_LT(errors.nees / errors.count, 1.25);
  EXPECT_LT(std::sqrt(errors.over_bound / errors.count), 1.3);
}

TEST(Rig, SystematicErrorsOfLidarsAreInTheCovariance) {
  RigSimulation simulation{.cameras = 1, .lidars = 2, .moments = 8};
  simulation.sensors.errors = LidarErrorModel{};
  const PairErrors errors = ErrorsOver(simulation, 12);
  EXPECT_GT(errors.nees / errors.count, 0.8);
  EXPECT_LT(errors.nees / errors.count, 1.25);
}

TEST(Rig, CamerasAloneAndLidarsAloneAreCases) {
  for (const auto& [cameras, lidars] : {std::pair(3, 0), std::pair(0, 3)}) {
    RigSimulation simulation{.cameras = cameras, .lidars = lidars, .moments = 8};
    const PairErrors errors = ErrorsOver(simulation, 8);
    EXPECT_GT(errors.nees / errors.count, 0.75) << cameras << " cameras";
    EXPECT_LT(errors.nees / errors.count, 1.3) << cameras << " cameras";
  }
}

TEST(Rig, OneCameraAndOneLidarAreTheCaseOfTwoSensors) {
  const auto joint = *BuiltinSolvers().Make("joint(gnc(kabsch))");
  for (int seed = 1; seed <= 6; ++seed) {
    ViewSimulation simulation{.seed = static_cast<std::uint64_t>(seed), .views = 8};
    simulation.errors = LidarErrorModel{};
    const auto views = SimulateViews(simulation);
    ASSERT_TRUE(views);
    RigProblem rig{.boards = views->problem.boards};
    rig.sensors.push_back({.name = "cam", .camera = views->problem.camera});
    rig.sensors.push_back({.name = "lidar", .lidar_errors = views->problem.lidar_errors});
    for (const BoardView& view : views->problem.board_views) {
      RigPlacement placement{.moment = view.view, .board = view.board, .name = "", .seen = {}};
      placement.seen = {{.sensor = 0}, {.sensor = 1, .sensor_from_board = view.lidar_from_board}};
      placement.seen[0].raw.printed = view.printed;
      placement.seen[1].raw = view;
      placement.seen[1].raw.printed.clear();
      rig.placements.push_back(std::move(placement));
    }
    const auto solved = SolveRig(rig);
    ASSERT_TRUE(solved) << solved.error().message;
    const auto report = joint->Solve(views->problem);
    ASSERT_TRUE(report) << report.error().message;
    const UncertainPose pose = solved->Between(0, 1);
    const Vector6d off = PoseDifference(pose.b_from_a, report->cam_from_lidar);
    EXPECT_LT(SquaredMahalanobis<6>(off, *report->covariance) / 6.0, 0.3 * 0.3) << seed;
    EXPECT_NEAR(std::log(pose.covariance.trace() / report->covariance->trace()), 0.0, 0.2) << seed;
  }
}

TEST(Rig, JointIsBetterThanChaining) {
  // Each sensor misses some moments, so that the chain does not use what the cameras see together.
  RigSimulation simulation{.cameras = 2, .lidars = 1, .moments = 12, .takes_part = 0.7};
  simulation.sensors.azimuth_step_deg = kCoarseAzimuth_deg;
  simulation.sensors.errors = LidarErrorModel{};
  double joint = 0.0;
  double chained = 0.0;
  for (int i = 0; i < 10; ++i) {
    simulation.seed = static_cast<std::uint64_t>(i + 1);
    const SimulatedRig rig = SimulateRig(simulation);
    const auto all = SolveRig(rig.problem);
    const std::vector<std::size_t> first = {0, 2};
    const std::vector<std::size_t> second = {1, 2};
    const auto a = SolveRig(Restricted(rig.problem, first));
    const auto b = SolveRig(Restricted(rig.problem, second));
    ASSERT_TRUE(all && a && b);
    const Rigid3d truth = rig.TrueBetween(0, 1);
    const Rigid3d chain = a->Between(0, 1).b_from_a * b->Between(1, 0).b_from_a;
    joint += std::pow(DistanceBetween(all->Between(0, 1).b_from_a, truth).translation_m, 2);
    chained += std::pow(DistanceBetween(chain, truth).translation_m, 2);
  }
  EXPECT_LT(std::sqrt(joint), std::sqrt(chained) / 1.5);
}

TEST(Rig, ASensorThatSharesNoViewIsNamedWithWhatWouldConnectIt) {
  SimulatedRig rig = SimulateRig({.cameras = 2, .lidars = 1, .moments = 6});
  for (RigPlacement& placement : rig.problem.placements) {
    std::erase_if(placement.seen, [](const RigObservation& seen) { return seen.sensor == 1; });
  }
  const auto estimate = SolveRig(rig.problem);
  ASSERT_TRUE(estimate) << estimate.error().message;
  EXPECT_FALSE(estimate->sensor_from_root[1]);
  ASSERT_EQ(estimate->unconnected.size(), 1U);
  EXPECT_THAT(estimate->unconnected[0], HasSubstr("'cam_1' shares no view"));
  EXPECT_THAT(estimate->unconnected[0], HasSubstr("record 3 moments"));
  const auto off = DistanceBetween(estimate->Between(0, 2).b_from_a, rig.TrueBetween(0, 2));
  EXPECT_LT(off.translation_m, 0.05);
}

TEST(Rig, NoConnectedSensorIsAnError) {
  SimulatedRig rig = SimulateRig({.cameras = 1, .lidars = 1, .moments = 3});
  for (RigPlacement& placement : rig.problem.placements) placement.seen.resize(1);
  const auto estimate = SolveRig(rig.problem);
  ASSERT_FALSE(estimate);
  EXPECT_EQ(ToString(estimate.error().code), "missing_data");
  EXPECT_THAT(estimate.error().message, HasSubstr("see a board"));
}

TEST(Rig, ABoardThatMovedBetweenSensorsIsLeftOutForOneOfThem) {
  RigSimulation simulation{.cameras = 2, .lidars = 1, .moments = 10};
  simulation.sensors.errors = LidarErrorModel{};
  SimulatedRig rig = SimulateRig(simulation);
  const Rigid3d moved = Perturb(Rigid3d{}, (Vector6d() << 0, 0, 0, 0.1, 0, 0.1).finished());
  for (RigObservation& seen : rig.problem.placements[4].seen) {
    if (seen.sensor != 2) continue;
    for (Eigen::Vector3d& point : seen.raw.face_in_lidar) point = moved * point;
    for (EdgeRay& ray : seen.raw.edges) {
      ray.direction = (moved * (2.0 * ray.direction)).normalized();
    }
  }
  const auto estimate = SolveRig(rig.problem);
  ASSERT_TRUE(estimate) << estimate.error().message;
  ASSERT_EQ(estimate->warnings.size(), 1U);
  EXPECT_THAT(estimate->warnings[0], HasSubstr("board 0 of moment 4 was left out for lidar_0"));
  const UncertainPose pose = estimate->Between(0, 2);
  const Vector6d error = PoseDifference(pose.b_from_a, rig.TrueBetween(0, 2));
  EXPECT_LT(SquaredMahalanobis<6>(error, pose.covariance), 22.5);  // 0.1 %
}

TEST(Rig, AWrongSizeOfThePrintIsRefuted) {
  for (const double share : {0.0, 0.05}) {
    RigSimulation simulation{.cameras = 2, .lidars = 1, .moments = 10};
    simulation.sensors.errors = LidarErrorModel{};
    SimulatedRig rig = SimulateRig(simulation);
    for (RigPlacement& placement : rig.problem.placements) {
      for (RigObservation& seen : placement.seen) {
        for (BoardPoints& printed : seen.raw.printed) {
          for (Eigen::Vector2d& point : printed.in_board_m) point *= 1.0 + share;
        }
      }
    }
    const auto estimate = SolveRig(rig.problem);
    ASSERT_TRUE(estimate) << estimate.error().message;
    ASSERT_EQ(estimate->refutations.size(), share > 0.0 ? 2U : 0U);
    for (const std::string& reason : estimate->refutations) {
      EXPECT_THAT(reason, HasSubstr("% smaller than stated"));
    }
  }
}

TEST(Rig, ScansOfOtherMomentsAreRefuted) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    RigSimulation simulation{.seed = seed, .cameras = 1, .lidars = 1, .moments = 8};
    simulation.sensors.azimuth_step_deg = kCoarseAzimuth_deg;
    simulation.sensors.errors = LidarErrorModel{};
    SimulatedRig rig = SimulateRig(simulation);
    auto& placements = rig.problem.placements;
    const RigObservation first = placements[0].seen[1];
    for (std::size_t i = 0; i + 1 < placements.size(); ++i) {
      placements[i].seen[1] = placements[i + 1].seen[1];
    }
    placements.back().seen[1] = first;
    const auto estimate = SolveRig(rig.problem);
    EXPECT_TRUE(!estimate || !estimate->refutations.empty()) << seed;
  }
}

/// The rig's boards as features that someone has extracted.
RigProblem AsFeatures(const SimulatedRig& rig, bool lines, double sigma_m, std::uint64_t seed) {
  RigProblem problem{.sensors = rig.problem.sensors, .boards = rig.problem.boards};
  for (RigSensor& sensor : problem.sensors) sensor.camera.reset();
  Random random(seed);
  const auto noise = [&] {
    Eigen::Vector3d error;
    for (double& along : error) along = sigma_m * random.Normal();
    return error;
  };
  const double half = 0.5 * problem.boards[0].top_right_m;
  const Eigen::Vector3d corners[] = {
      {-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  for (std::size_t i = 0; i < rig.problem.placements.size(); ++i) {
    RigPlacement placement{.moment = static_cast<int>(i), .board = problem.boards[0].id};
    for (std::size_t s = 0; s < problem.sensors.size(); ++s) {
      const Rigid3d pose = rig.sensor_from_rig[s] * rig.rig_from_board[i];
      RigObservation seen{.sensor = s};
      if (lines) {
        const Eigen::Vector3d normal = pose.rotation * Eigen::Vector3d::UnitZ();
        seen.plane = MeasuredPlane{.normal = -normal, .distance_m = -normal.dot(pose.translation)};
      }
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector3d from = pose * corners[k] + noise();
        const Eigen::Vector3d to = pose * corners[(k + 1) % 4] + noise();
        if (lines) {
          seen.lines.push_back({.side = k, .point = from, .direction = (to - from).normalized()});
        } else {
          seen.points.push_back({.in_board_m = corners[k], .in_sensor_m = from, .sigma_m = 0.01});
        }
      }
      placement.seen.push_back(std::move(seen));
    }
    problem.placements.push_back(std::move(placement));
  }
  return problem;
}

TEST(Rig, PointsOrPlanesAndLinesThatSomeoneExtractedAreEnough) {
  const SimulatedRig rig = SimulateRig({.cameras = 1, .lidars = 2, .moments = 6});
  for (const bool lines : {false, true}) {
    const auto exact = SolveRig(AsFeatures(rig, lines, 0.0, 1));
    ASSERT_TRUE(exact) << exact.error().message;
    for (std::size_t s = 0; s < 3; ++s) {
      const auto off = DistanceBetween(*exact->sensor_from_root[s], rig.TrueBetween(s, 0));
      EXPECT_LT(off.translation_m, 1e-6) << lines;
    }
    const auto noisy = SolveRig(AsFeatures(rig, lines, 0.01, 1));
    ASSERT_TRUE(noisy) << noisy.error().message;
    const UncertainPose pose = noisy->Between(1, 2);
    EXPECT_LT((PoseDifference(pose.b_from_a, rig.TrueBetween(1, 2)).tail<3>().norm()), 0.03);
  }
}

TEST(Rig, PlanesAloneAreEnough) {
  const SimulatedRig rig = SimulateRig({.cameras = 0, .lidars = 2, .moments = 8});
  RigProblem problem = AsFeatures(rig, true, 0.0, 1);
  for (RigPlacement& placement : problem.placements) {
    for (RigObservation& seen : placement.seen) seen.lines.clear();
  }
  const auto estimate = SolveRig(problem);
  ASSERT_TRUE(estimate) << estimate.error().message;
  const auto off = DistanceBetween(estimate->Between(0, 1).b_from_a, rig.TrueBetween(0, 1));
  EXPECT_LT(off.translation_m, 1e-6);
}

TEST(Rig, WrongFeaturesOfOneSensorAreNamedWithTheRemedy) {
  const SimulatedRig rig = SimulateRig({.cameras = 1, .lidars = 2, .moments = 6});
  const auto refused = [&](bool lines, const auto& spoil, const char* reason) {
    RigProblem problem = AsFeatures(rig, lines, 0.005, 1);
    problem.sensors[0].camera = rig.problem.sensors[0].camera;
    for (RigPlacement& placement : problem.placements) {
      for (RigObservation& seen : placement.seen) spoil(seen);
    }
    const auto estimate = SolveRig(problem);
    ASSERT_FALSE(estimate) << reason;
    EXPECT_THAT(estimate.error().message, HasSubstr(reason));
  };
  const auto swap_points = [](RigObservation& seen, std::size_t a, std::size_t b) {
    if (seen.sensor == 2) std::swap(seen.points[a].in_sensor_m, seen.points[b].in_sensor_m);
  };
  refused(
      false,
      [](RigObservation& seen) {
        for (MeasuredPoint& point : seen.points) point.in_sensor_m *= seen.sensor == 1 ? 1e3 : 1.0;
      },
      "sensor 'lidar_0': its points of a board are");
  refused(
      false, [&](RigObservation& seen) { swap_points(seen, 1, 3); },
      "sensor 'lidar_1': its points show the back of the board");
  refused(
      false, [&](RigObservation& seen) { swap_points(seen, 2, 3); },
      "sensor 'lidar_1': its points do not have the form of the board");
  refused(
      true, [](RigObservation& seen) { seen.plane->distance_m *= seen.sensor == 2 ? -1.0 : 1.0; },
      "sensor 'lidar_1': its planes are on the other side of it than its points and lines");
  refused(
      true,
      [](RigObservation& seen) {
        seen.lines.clear();
        seen.plane->distance_m *= -1.0;
      },
      "sensor 'cam_0': its planes are behind the camera");
}

}  // namespace
}  // namespace sextant
