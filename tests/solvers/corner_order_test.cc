// SPDX-License-Identifier: Apache-2.0
#include "solvers/matching/corner_order.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/random_vectors.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

// Boards of 0.6 x 0.85 m about 3 m away; the corners of a are listed in `orders`.
std::vector<CornerGroup> Boards(const Rigid3d& b_from_a, std::span<const CornerOrder> orders,
                                double sigma_m, Random& random) {
  std::vector<CornerGroup> groups;
  for (const CornerOrder& order : orders) {
    const Rigid3d b_from_board{ExpSo3(0.4 * NormalVector(random)),
                               Eigen::Vector3d(0, 0, 3) + 0.7 * NormalVector(random)};
    CornerGroup group;
    group.in_a.resize(4);
    for (int k = 0; k < 4; ++k) {
      const double x = k == 0 || k == 3 ? -0.3 : 0.3;
      const double y = k < 2 ? -0.425 : 0.425;
      const Eigen::Vector3d in_b = b_from_board * Eigen::Vector3d(x, y, 0.0);
      group.in_b.push_back(in_b + sigma_m * NormalVector(random));
      group.in_a[static_cast<std::size_t>(order.IndexInA(k, 4))] = b_from_a.Inverse() * in_b;
    }
    groups.push_back(group);
  }
  return groups;
}

TEST(CornerOrder, FindsEveryOrderFromTwoBoardsOn) {
  Random random(1);
  for (int trial = 0; trial < 100; ++trial) {
    const Rigid3d truth{ExpSo3(NormalVector(random)), NormalVector(random)};
    std::vector<CornerOrder> orders(2 + random.Below(10));
    for (CornerOrder& order : orders) {
      order.first = static_cast<int>(random.Below(4));
      order.reversed = random.Below(2) == 1;
    }
    const auto groups = Boards(truth, orders, 0.01, random);
    const Expected<CornerOrderFit> fit = ResolveCornerOrders(groups);
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_EQ(fit->orders, orders) << trial;
    // 12 residuals per board at 10 mm per axis: the RMSE of a point is below 17.3 mm + 5 sigma.
    EXPECT_LT(fit->rmse_m, 0.030);
  }
}

TEST(CornerOrder, KeepsTheListedOrderWhereOneBoardDoesNotDetermineIt) {
  Random random(2);
  const Rigid3d truth{ExpSo3(NormalVector(random)), NormalVector(random)};
  const CornerOrder as_listed[] = {{.first = 0, .reversed = false}};
  const auto groups = Boards(truth, as_listed, 0.0, random);
  const Expected<CornerOrderFit> fit = ResolveCornerOrders(groups);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->orders[0], as_listed[0]);
  EXPECT_LT(fit->rmse_m, 1e-7);
}

TEST(CornerOrder, RefusesDegenerateBoards) {
  EXPECT_EQ(ResolveCornerOrders({}).error().code, ErrorCode::kTooFewPairs);
  CornerGroup uneven{.in_b = {3, Eigen::Vector3d::Zero()}, .in_a = {4, Eigen::Vector3d::Zero()}};
  EXPECT_EQ(ResolveCornerOrders({&uneven, 1}).error().code, ErrorCode::kInvalidInput);
  CornerGroup point{.in_b = {4, Eigen::Vector3d::Zero()}, .in_a = {4, Eigen::Vector3d::Ones()}};
  EXPECT_EQ(ResolveCornerOrders({&point, 1}).error().code, ErrorCode::kDegenerate);
}

}  // namespace
}  // namespace sextant
