// SPDX-License-Identifier: Apache-2.0
#include "solvers/matching/point_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "base/random.h"
#include "geometry/random_vectors.h"
#include "geometry/so3.h"
#include "solvers/matching/min_cost_assignment.h"

namespace sextant {
namespace {

std::vector<int> ShuffledIndices(int n, Random& random) {
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.Below(i)]);
  return order;
}

TEST(MinCostAssignment, IsTheLeastOfAllPermutations) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + static_cast<int>(random.Below(6));
    std::vector<double> costs;
    for (int i = 0; i < n * n; ++i) costs.push_back(random.Uniform(-1.0, 5.0));
    std::vector<int> columns(static_cast<std::size_t>(n));
    std::iota(columns.begin(), columns.end(), 0);
    double least = 1e9;
    do {
      double sum = 0.0;
      for (int row = 0; row < n; ++row) {
        sum += costs[static_cast<std::size_t>(n * row + columns[static_cast<std::size_t>(row)])];
      }
      least = std::min(least, sum);
    } while (std::ranges::next_permutation(columns).found);
    EXPECT_NEAR(AssignAtMinCost(costs, n).cost, least, 1e-12) << trial;
  }
}

// Points of a scene 2.5 m in front of the camera; the LiDAR point of pair i belongs to the camera
// point of pair order[i].
struct ShuffledPoints {
  std::vector<Pair3d3d> points;
  std::vector<Pair2d3d> pixels;
  Rigid3d truth;
  std::vector<int> expected;  // lidar_index of the true order.
};

const Camera kOrderCamera{.width_px = 1280,
                          .height_px = 720,
                          .fx_px = 800.0,
                          .fy_px = 800.0,
                          .cx_px = 640.0,
                          .cy_px = 360.0};

ShuffledPoints Shuffle(int n, const std::vector<int>& order, Random& random) {
  ShuffledPoints made;
  made.truth = {ExpSo3(0.5 * NormalVector(random)), 0.2 * NormalVector(random)};
  std::vector<Eigen::Vector3d> in_cam;
  for (int i = 0; i < n; ++i) {
    const double x = random.Uniform(-1.0, 1.0);
    const double y = random.Uniform(-0.6, 0.6);
    const double z = random.Uniform(2.0, 3.0);
    in_cam.emplace_back(x, y, z);
  }
  made.expected.resize(static_cast<std::size_t>(n));
  for (std::size_t i = 0; i < in_cam.size(); ++i) {
    const auto from = static_cast<std::size_t>(order[i]);
    const Eigen::Vector3d in_lidar = made.truth.Inverse() * in_cam[from];
    made.expected[from] = static_cast<int>(i);
    made.points.push_back({.point_in_cam = in_cam[i] + 0.005 * NormalVector(random),
                           .point_in_lidar = in_lidar,
                           .sigma_m = 0.0,
                           .covariance_in_cam = {},
                           .id = {}});
    const double du = 0.5 * random.Normal();
    const double dv = 0.5 * random.Normal();
    made.pixels.push_back({.pixel = *Project(kOrderCamera, in_cam[i]) + Eigen::Vector2d(du, dv),
                           .point_in_lidar = in_lidar,
                           .sigma_px = 0.0,
                           .id = {}});
  }
  return made;
}

OrderView AllOf(int n) {
  PointGroup group(static_cast<std::size_t>(n));
  std::iota(group.begin(), group.end(), 0);
  return {.groups = {group}};
}

TEST(PointOrder, FindsAnyOrderOfPoints) {
  Random random(2);
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 5 + trial % 8;
    const ShuffledPoints made = Shuffle(n, ShuffledIndices(n, random), random);
    const std::vector<OrderView> views = {AllOf(n)};
    const std::vector<PointOrder> found = FindPointOrders(*ModelOf(made.points), views);
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found.front().lidar_index, made.expected) << n << " points, trial " << trial;
    EXPECT_LT(found.front().rmse, 0.02);
  }
}

TEST(PointOrder, FindsAnyOrderOfPixels) {
  Random random(3);
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 7 + trial % 6;
    const ShuffledPoints made = Shuffle(n, ShuffledIndices(n, random), random);
    const std::vector<OrderView> views = {AllOf(n)};
    const auto found = FindPointOrders(*ModelOf(made.pixels, kOrderCamera), views);
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found.front().lidar_index, made.expected) << n << " points, trial " << trial;
    EXPECT_LT(DistanceBetween(found.front().cam_from_lidar, made.truth).translation_m, 0.2);
  }
}

// `boards` groups of four points, spread over views of `per_view` groups, with exchanged groups and
// any order within each.
TEST(PointOrder, FindsExchangedGroupsOfAView) {
  Random random(4);
  for (int trial = 0; trial < 10; ++trial) {
    constexpr int kGroups = 5;
    const std::vector<int> groups = ShuffledIndices(kGroups, random);
    std::vector<int> order;
    OrderView view;
    for (int g = 0; g < kGroups; ++g) {
      const std::vector<int> within = ShuffledIndices(4, random);
      PointGroup& group = view.groups.emplace_back();
      for (int i = 0; i < 4; ++i) {
        order.push_back(4 * groups[static_cast<std::size_t>(g)] +
                        within[static_cast<std::size_t>(i)]);
        group.push_back(4 * g + i);
      }
    }
    const ShuffledPoints made = Shuffle(4 * kGroups, order, random);
    const auto found = FindPointOrders(*ModelOf(made.points), std::span(&view, 1));
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found.front().lidar_index, made.expected) << trial;
  }
}

TEST(PointOrder, TenThousandPairsInOneViewWithEveryBoardReversed) {
  Random random(5);
  constexpr int kPairs = 10'000;
  std::vector<int> order;
  OrderView view;
  for (int i = 0; i < kPairs; i += 4) {
    for (const int k : {0, 3, 2, 1}) order.push_back(i + k);
    view.groups.push_back({i, i + 1, i + 2, i + 3});
  }
  const ShuffledPoints made = Shuffle(kPairs, order, random);
  const auto found = FindPointOrders(*ModelOf(made.points), std::span(&view, 1));
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().lidar_index, made.expected);
}

TEST(PointOrder, PairsInNoGroupKeepTheirPoint) {
  Random random(6);
  std::vector<int> order = {1, 2, 3, 0, 4, 5, 6};
  const ShuffledPoints made = Shuffle(7, order, random);
  const std::vector<OrderView> views = {{.groups = {{0, 1, 2, 3}}}};
  const auto found = FindPointOrders(*ModelOf(made.points), views);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().lidar_index, made.expected);
  EXPECT_TRUE(FindPointOrders(*ModelOf(made.points), {}).empty());
}

TEST(PointOrder, FitsTheGivenOrder) {
  Random random(7);
  std::vector<int> same(9);
  std::iota(same.begin(), same.end(), 0);
  const ShuffledPoints made = Shuffle(9, same, random);
  const auto by_points = FitGivenOrder(*ModelOf(made.points));
  const auto by_pixels = FitGivenOrder(*ModelOf(made.pixels, kOrderCamera));
  ASSERT_TRUE(by_points && by_pixels);
  EXPECT_EQ(by_points->lidar_index, same);
  EXPECT_LT(by_points->rmse, 0.02);
  EXPECT_LT(by_pixels->rmse, 1.5);
}

}  // namespace
}  // namespace sextant
