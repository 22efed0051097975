// SPDX-License-Identifier: Apache-2.0
#include "geometry/scan_marks.h"

#include <gtest/gtest.h>

namespace sextant {
namespace {

Quadrilateral Reversed(const Quadrilateral& q) { return {q[3], q[2], q[1], q[0]}; }

const Quadrilateral& Kite() {
  static const Quadrilateral kite = {Eigen::Vector2d(0, 0), Eigen::Vector2d(10, 4),
                                     Eigen::Vector2d(20, 0), Eigen::Vector2d(10, 20)};
  return kite;
}

TEST(ScanMarks, ContainsDoesNotDependOnTheDirectionOfDrawing) {
  for (const Quadrilateral& q : {Kite(), Reversed(Kite())}) {
    EXPECT_TRUE(Contains(q, {10, 10}));
    EXPECT_TRUE(Contains(q, {2, 1.5}));
    EXPECT_FALSE(Contains(q, {10, 3.9}));  // In the notch: it is not convex.
    EXPECT_TRUE(Contains(q, {10, 4.1}));
    EXPECT_FALSE(Contains(q, {-1, 0}));
    EXPECT_FALSE(Contains(q, {10, 20.1}));
    EXPECT_FALSE(Contains(q, {25, 5}));
  }
}

TEST(ScanMarks, QuadrilateralsThatShareASideShareNoPixel) {
  const Quadrilateral left = {Eigen::Vector2d(0, 0), Eigen::Vector2d(5, 0), Eigen::Vector2d(7, 9),
                              Eigen::Vector2d(0, 9)};
  const Quadrilateral right = {Eigen::Vector2d(5, 0), Eigen::Vector2d(12, 0),
                               Eigen::Vector2d(12, 9), Eigen::Vector2d(7, 9)};
  for (int u = 1; u < 12; ++u) {
    for (int v = 0; v < 9; ++v) {
      const Eigen::Vector2d pixel(u, v);
      EXPECT_NE(Contains(left, pixel), Contains(right, pixel)) << u << " " << v;
    }
  }
}

TEST(ScanMarks, CrossingSidesAreSeen) {
  EXPECT_FALSE(CrossesItself(Kite()));
  EXPECT_FALSE(CrossesItself(Reversed(Kite())));
  const Quadrilateral k = {Eigen::Vector2d(0, 0), Eigen::Vector2d(9, 1), Eigen::Vector2d(8, 9),
                           Eigen::Vector2d(1, 7)};
  EXPECT_FALSE(CrossesItself(k));
  EXPECT_TRUE(CrossesItself({k[0], k[2], k[1], k[3]}));
  EXPECT_TRUE(CrossesItself({k[0], k[1], k[3], k[2]}));
}

TEST(ScanMarks, EdgesAreCountedFromTheTopLeftAndSidesFromTheTopRight) {
  // The edge from the left to the top corner is side 3 of a Board; then clockwise.
  EXPECT_EQ(SideOfMarkedEdge(0), 3);
  EXPECT_EQ(SideOfMarkedEdge(1), 0);
  EXPECT_EQ(SideOfMarkedEdge(2), 1);
  EXPECT_EQ(SideOfMarkedEdge(3), 2);
}

TEST(ScanMarks, TheAssumedCameraLooksAlongTheLidarsX) {
  const Camera camera = AssumedCamera(1280, 720);
  EXPECT_TRUE(ValidateCamera(camera));
  const Rigid3d cam_from_lidar = AxesCamFromLidar();
  const auto ahead = Project(camera, cam_from_lidar * Eigen::Vector3d(3, 0, 0));
  const auto left = Project(camera, cam_from_lidar * Eigen::Vector3d(3, 1, 0));
  const auto above = Project(camera, cam_from_lidar * Eigen::Vector3d(3, 0, 1));
  ASSERT_TRUE(ahead && left && above);
  EXPECT_TRUE(ahead->isApprox(Eigen::Vector2d(639.5, 359.5)));
  EXPECT_LT(left->x(), ahead->x());
  EXPECT_LT(above->y(), ahead->y());
  EXPECT_FALSE(Project(camera, cam_from_lidar * Eigen::Vector3d(-3, 0, 0)));
  // 45 degrees to the left is the border of the image.
  EXPECT_NEAR(Project(camera, cam_from_lidar * Eigen::Vector3d(1, 1, 0))->x(), -0.5, 1e-9);
}

}  // namespace
}  // namespace sextant
