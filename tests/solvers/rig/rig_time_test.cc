// SPDX-License-Identifier: Apache-2.0
// Rigs whose clocks differ, and boards that move.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "eval/synthetic/simulate_rig.h"
#include "geometry/symmetric.h"
#include "solvers/rig/solve_rig.h"

namespace sextant {
namespace {

/// Sensors whose clocks are off by up to 20 ms, and a board that moves by 0.3 m/s.
RigSimulation MovingBoards(std::uint64_t seed, int moments) {
  RigSimulation simulation{.seed = seed, .cameras = 2, .lidars = 1, .moments = moments};
  // Few returns, as each sensor sees the board three times.
  simulation.sensors.azimuth_step_deg = 1.0;
  simulation.speed_m_s = 0.3;
  simulation.clock_ahead_s = {0.0, 0.012, -0.02};
  return simulation;
}

double NumberOf(const RigEstimate& estimate, std::size_t sensor, const char* name, double& sigma) {
  for (const RigEstimatedNumber& number : estimate.numbers) {
    if (number.sensor != sensor || number.name != name) continue;
    sigma = number.sigma;
    return number.value;
  }
  ADD_FAILURE() << name << " of sensor " << sensor;
  return 0.0;
}

TEST(RigTime, ExactMovingBoardsGiveTheTruth) {
  RigSimulation simulation = MovingBoards(3, 8);
  simulation.sensors.exact = true;
  const SimulatedRig rig = SimulateRig(simulation);
  const auto estimate = SolveRig(rig.problem, {.estimate_time = true});
  ASSERT_TRUE(estimate) << estimate.error().message;
  for (std::size_t s = 1; s < 3; ++s) {
    double sigma = 0.0;
    EXPECT_NEAR(NumberOf(*estimate, s, "time_offset_s", sigma), simulation.clock_ahead_s[s], 1e-4);
    const auto off = DistanceBetween(*estimate->sensor_from_root[s], rig.TrueBetween(s, 0));
    EXPECT_LT(off.translation_m, 2e-5);
  }
}

TEST(RigTime, OffsetsArePreciseAndTheirCovarianceIsHonest) {
  double nees = 0.0;
  double squares = 0.0;
  double pose_nees = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    RigSimulation simulation = MovingBoards(seed, 12);
    simulation.acceleration_m_s2 = 1.0;
    const SimulatedRig rig = SimulateRig(simulation);
    const auto estimate = SolveRig(rig.problem, {.estimate_time = true});
    ASSERT_TRUE(estimate) << estimate.error().message;
    for (std::size_t s = 1; s < 3; ++s) {
      double sigma = 0.0;
      const double error =
          NumberOf(*estimate, s, "time_offset_s", sigma) - simulation.clock_ahead_s[s];
      nees += std::pow(error / sigma, 2);
      squares += error * error;
      const UncertainPose pose = estimate->Between(s, 0);
      const Vector6d off = PoseDifference(pose.b_from_a, rig.TrueBetween(s, 0));
      pose_nees += SquaredMahalanobis<6>(off, pose.covariance) / 6.0;
      ++count;
    }
  }
  // chi^2 of 24 over its mean: 0.38 to 1.9 with 0.3 % on either side.
  EXPECT_GT(nees / count, 0.38);
  EXPECT_LT(nees / count, 1.9);
  EXPECT_LT(std::sqrt(squares / count), 0.002);
  EXPECT_GT(pose_nees / count, 0.65);
  EXPECT_LT(pose_nees / count, 1.45);
}

TEST(RigTime, BoardsAtRestDoNotTellAnOffset) {
  RigSimulation simulation = MovingBoards(1, 8);
  simulation.speed_m_s = 1e-6;
  simulation.turn_rad_s = 0.0;
  const SimulatedRig rig = SimulateRig(simulation);
  const auto estimate = SolveRig(rig.problem, {.estimate_time = true});
  ASSERT_TRUE(estimate) << estimate.error().message;
  ASSERT_EQ(estimate->warnings.size(), 2U);
  EXPECT_THAT(estimate->warnings[0],
              testing::HasSubstr("does not determine the time offset of cam_1"));
  const auto is_offset = [](const RigEstimatedNumber& number) {
    return number.name == "time_offset_s";
  };
  EXPECT_TRUE(std::ranges::none_of(estimate->numbers, is_offset));
  // Where the boards are stated to move, the offsets are estimated all the same.
  const auto known = SolveRig(rig.problem, {.estimate_time = true, .boards_move = true});
  ASSERT_TRUE(known) << known.error().message;
  EXPECT_EQ(std::ranges::count_if(known->numbers, is_offset), 2);
}

}  // namespace
}  // namespace sextant
