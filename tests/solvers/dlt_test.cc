// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/dlt.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/so3.h"
#include "support/scenes.h"

namespace sextant {
namespace {

struct DltView {
  std::vector<Eigen::Vector2d> image_points;
  std::vector<Eigen::Vector3d> points;
};

DltView ViewOf(const test::PairScene& scene) {
  DltView view;
  for (const Pair2d3d& pair : scene.problem.pairs_2d3d) {
    view.image_points.push_back(Unproject(*scene.problem.camera, pair.pixel)->hnormalized());
    view.points.push_back(pair.point_in_lidar);
  }
  return view;
}

class DltCounts : public testing::TestWithParam<int> {};

TEST_P(DltCounts, RecoversExactPoses) {
  Random random(1);
  const int trials = GetParam() < 100 ? 1000 : 50;
  for (const double depth : {2.0, 3.0, 30.0}) {
    for (int trial = 0; trial < trials; ++trial) {
      const test::PairScene scene =
          test::MakeScene({.pairs = GetParam(), .depth_m = depth}, random);
      const DltView view = ViewOf(scene);
      const Expected<Rigid3d> pose = SolveDlt(view.image_points, view.points);
      ASSERT_TRUE(pose) << pose.error().message;
      const PoseDistance off = DistanceBetween(*pose, scene.cam_from_lidar);
      EXPECT_LT(off.rotation_rad, 1e-8) << "depth " << depth << " trial " << trial;
      EXPECT_LT(off.translation_m, 1e-8 * depth) << "depth " << depth << " trial " << trial;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(FewToMany, DltCounts, testing::Values(7, 8, 20, 1000));

// Six points give one redundant equation, and some sets are close to a critical surface with none.
TEST(Dlt, RecoversMostExactPosesFromSixPoints) {
  Random random(2);
  int lost = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const test::PairScene scene = test::MakeScene({.pairs = 6}, random);
    const DltView view = ViewOf(scene);
    const Expected<Rigid3d> pose = SolveDlt(view.image_points, view.points);
    ASSERT_TRUE(pose) << pose.error().message;
    if (DistanceBetween(*pose, scene.cam_from_lidar).rotation_rad > 1e-8) ++lost;
  }
  EXPECT_LE(lost, 2);
}

TEST(Dlt, RefusesDegenerateSets) {
  Random random(3);
  const auto code = [](const DltView& view) {
    const Expected<Rigid3d> pose = SolveDlt(view.image_points, view.points);
    return pose ? ErrorCode::kIo : pose.error().code;
  };
  EXPECT_EQ(code(ViewOf(test::MakeScene({.pairs = 5}, random))), ErrorCode::kTooFewPairs);
  EXPECT_EQ(code(ViewOf(test::MakeScene({.pairs = 12, .planar = true}, random))),
            ErrorCode::kDegenerate);
  DltView behind = ViewOf(test::MakeScene({.pairs = 12}, random));
  // An image rotated by half a turn, as if the points were behind the camera.
  for (Eigen::Vector2d& point : behind.image_points) point = -point;
  for (Eigen::Vector3d& point : behind.points) point = -point;
  EXPECT_EQ(code(behind), ErrorCode::kMirrored);
  DltView one_pixel = ViewOf(test::MakeScene({.pairs = 12}, random));
  for (Eigen::Vector2d& point : one_pixel.image_points) point = {0.1, 0.2};
  EXPECT_EQ(code(one_pixel), ErrorCode::kDegenerate);
  DltView repeated = ViewOf(test::MakeScene({.pairs = 5}, random));
  repeated.points.push_back(repeated.points[0]);
  repeated.image_points.push_back(repeated.image_points[0]);
  EXPECT_EQ(code(repeated), ErrorCode::kDegenerate);
}

}  // namespace
}  // namespace sextant
