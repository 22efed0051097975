// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/view_comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "eval/synthetic/simulate_views.h"

namespace sextant {
namespace {

constexpr int kComparedViews = 8;

// Near and far views: a far one shows a few rings only. With a third of the usual returns on each,
// for the time.
SimulatedViews NearAndFar(std::uint64_t seed) {
  ViewSimulation simulation{.seed = seed,
                            .views = kComparedViews,
                            .nearest_m = 1.5,
                            .farthest_m = 4.0,
                            .azimuth_step_deg = 0.6};
  simulation.errors = LidarErrorModel{};
  return SimulateViews(simulation).value();
}

// At the level at which one of all views is marked by chance in 1 percent of the sessions.
bool IsMarked(const ViewComparison& view) {
  const double tail = 0.5 * std::erfc(view.disagreement / std::numbers::sqrt2);
  return !view.used || tail < 0.01 / kComparedViews;
}

// Turns all returns of a view about the LiDAR's axis.
void TurnScan(BoardView& view, double angle_rad) {
  const Rigid3d turn{ExpSo3({0.0, 0.0, angle_rad}), Eigen::Vector3d::Zero()};
  for (Eigen::Vector3d& point : view.face_in_lidar) point = turn * point;
  for (EdgeRay& edge : view.edges) edge.direction = turn.rotation * edge.direction;
  view.lidar_from_board = turn * view.lidar_from_board;
}

TEST(CompareViews, AFarViewMayDifferMoreThanANearOne) {
  constexpr int kSessions = 100;
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= kSessions; ++seed) {
    const SimulatedViews session = NearAndFar(seed);
    const auto views = CompareViews(session.problem, session.true_cam_from_lidar);
    ASSERT_TRUE(views) << views.error().message;
    ASSERT_EQ(views->size(), static_cast<std::size_t>(kComparedViews));
    alarms += std::ranges::any_of(*views, IsMarked) ? 1 : 0;
  }
  EXPECT_LE(alarms, 4);  // 1 on average, and at most 3 sigma more.
}

TEST(CompareViews, TheScanOfAnotherMomentIsMarked) {
  constexpr int kSessions = 20;
  constexpr std::size_t kWrong = 3;
  int found = 0;
  for (std::uint64_t seed = 1; seed <= kSessions; ++seed) {
    SimulatedViews session = NearAndFar(seed);
    TurnScan(session.problem.board_views[kWrong], 0.04);  // 60 to 160 mm.
    const auto views = CompareViews(session.problem, session.true_cam_from_lidar);
    ASSERT_TRUE(views) << views.error().message;
    found += IsMarked((*views)[kWrong]) ? 1 : 0;
  }
  EXPECT_GE(found, kSessions - 1);
}

}  // namespace
}  // namespace sextant
