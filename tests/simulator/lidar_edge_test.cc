// SPDX-License-Identifier: Apache-2.0
// Effects of the spot size at the edges of objects.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "simulator/lidar/lidar_beam.h"
#include "support/lidar_scenes.h"

namespace sextant {
namespace {

using test::Facing;
using test::FullRoom;
using test::Model;
using test::Noiseless;
using test::Scan;

constexpr double kBoard = 2.0;  // Distance in metres.
constexpr double kWidth = 0.8;

Scene BoardBefore(double wall_distance_m) {
  Scene scene;
  scene.boards = {test::PlainBoard(Facing({kBoard, 0.0, 0.0}, {1.0, 0.0, 0.0}), kWidth, 2.0)};
  if (wall_distance_m > 0.0) {
    scene.walls = {
        test::Wall("behind", Facing({wall_distance_m, 0.0, 0.0}, {1.0, 0.0, 0.0}), 12.0, 12.0)};
    scene.walls[0].surface.reflectivity = scene.boards[0].white.reflectivity;
  }
  return scene;
}

// One ring with ten thousand columns per revolution, so that the azimuth step is 1.3 mm on the
// board.
LidarModel FineVlp16() {
  LidarModel model = Model("vlp16");
  model.rings = {{.elevation_rad = 0.0}};
  model.column_period_s = 1e-5;
  return model;
}

ScanOptions OnlySpot() {
  ScanOptions options = Noiseless();
  options.divergence = true;
  return options;
}

struct Extent {
  double left_m = -1.0;
  double right_m = 1.0;
};

// Width of the points on the board, measured where their central rays intersect its plane.
Extent BoardExtent(const SimulatedScan& scan) {
  Extent extent;
  for (std::size_t i = 0; i < scan.truth.size(); ++i) {
    if (scan.truth[i].object != SceneObject::kBoard) continue;
    const Eigen::Vector3d& p = scan.cloud.points[i];
    const double y = p.y() * kBoard / p.x();
    extent.left_m = std::max(extent.left_m, y);
    extent.right_m = std::min(extent.right_m, y);
  }
  return extent;
}

// 12.7 mm and 3 mrad: 18.7 mm at 2 m, in twelve parts, and a step of 1.3 mm.
constexpr double kSpot = 0.0127 + kBoard * 0.003;
constexpr double kResolution = kSpot / 12.0 + 0.0013;

TEST(LidarEdge, ABoardWithoutBackgroundAppearsHalfASpotWiderOnEachSide) {
  const Extent extent = BoardExtent(Scan(BoardBefore(0.0), FineVlp16(), OnlySpot()));
  EXPECT_NEAR(extent.left_m, 0.5 * kWidth + 0.5 * kSpot, kResolution);
  EXPECT_NEAR(extent.right_m, -0.5 * kWidth - 0.5 * kSpot, kResolution);
}

// The wall is equally bright and twice as far away, so the board is the stronger echo from a fifth
// of the spot on: f / 4 > (1 - f) / 16.
TEST(LidarEdge, ABrightWallBehindRemovesTheWidening) {
  const Extent extent = BoardExtent(Scan(BoardBefore(4.0), FineVlp16(), OnlySpot()));
  EXPECT_NEAR(extent.left_m, 0.5 * kWidth + 0.3 * kSpot, kResolution);
  EXPECT_NEAR(extent.right_m, -0.5 * kWidth - 0.3 * kSpot, kResolution);
}

TEST(LidarEdge, WithoutDivergenceTheEdgeIsExact) {
  const Extent extent = BoardExtent(Scan(BoardBefore(4.0), FineVlp16(), Noiseless()));
  EXPECT_NEAR(extent.left_m, 0.5 * kWidth, 0.0013);
  EXPECT_NEAR(extent.right_m, -0.5 * kWidth, 0.0013);
}

// Excludes the wall's own ends, where the illuminated part is far from the central ray.
bool NearBoard(const Eigen::Vector3d& point) { return std::abs(point.y()) < 1.0; }

int PointsBetween(const SimulatedScan& scan, double low_x, double high_x) {
  return static_cast<int>(std::ranges::count_if(scan.cloud.points, [=](const Eigen::Vector3d& p) {
    return NearBoard(p) && p.x() > low_x && p.x() < high_x;
  }));
}

TEST(LidarEdge, MixedPointsLieBetweenNearSurfaces) {
  const SimulatedScan near = Scan(BoardBefore(2.5), FineVlp16(), OnlySpot());
  // Two edges of one spot each, in steps of 1.3 mm.
  EXPECT_NEAR(PointsBetween(near, 2.01, 2.49), 2.0 * kSpot / 0.00127, 5.0);
  const SimulatedScan far = Scan(BoardBefore(3.5), FineVlp16(), OnlySpot());
  EXPECT_EQ(PointsBetween(far, 2.01, 3.49), 0);
}

TEST(LidarEdge, MixedPointsAreMarked) {
  const SimulatedScan scan = Scan(BoardBefore(2.5), FineVlp16(), OnlySpot());
  for (std::size_t i = 0; i < scan.truth.size(); ++i) {
    if (!NearBoard(scan.cloud.points[i])) continue;
    const double x = scan.cloud.points[i].x();
    const bool mixed = scan.truth[i].mixed;
    ASSERT_TRUE(mixed || x < 2.01 || x > 2.49) << x;
    ASSERT_TRUE(!mixed || (x > 2.0 && x < 2.5)) << x;
  }
}

// Points of many scans, each slightly rotated relative to the previous one.
int PointsOf(const Scene& scene, LidarModel model, bool dropouts) {
  int points = 0;
  for (int k = 0; k < 60; ++k) {
    model.start_azimuth_rad += 1e-4;
    ScanOptions options = OnlySpot();
    options.dropouts = dropouts;
    options.scan_index = k;
    points += static_cast<int>(Scan(scene, model, options).cloud.points.size());
  }
  return points;
}

// Fractions s of a spot come in twelfths: of those below one half, 1 - 2 s are lost, 5/24 of a
// spot's width.
TEST(LidarEdge, SpotsThatHardlyHitAreLost) {
  LidarModel model = FineVlp16();
  model.dropout = 0.0;
  const Scene scene = BoardBefore(0.0);
  const int lost = PointsOf(scene, model, false) - PointsOf(scene, model, true);
  const double expected = 60 * 2.0 * 5.0 / 24.0 * kSpot / 0.00127;
  EXPECT_NEAR(lost, expected, 4.0 * std::sqrt(expected) + 0.05 * expected);
}

// 4 s (1 - s) is 2/3 on average while a spot crosses an edge. The ring crosses two edges, into and
// out of the black square in the middle.
TEST(LidarEdge, SpotsHalfOnBlackAreLost) {
  LidarModel model = FineVlp16();
  model.dropout = 0.0;
  model.edge_dropout = 0.0;
  Scene scene;
  scene.boards = {test::PlainBoard(Facing({kBoard, 0.0, 0.0}, {1.0, 0.0, 0.0}), 1.4, 1.4)};
  scene.boards[0].board.checker =
      BoardChecker{.inner_columns = 2, .inner_rows = 2, .square_m = 0.4};
  const int lost = PointsOf(scene, model, false) - PointsOf(scene, model, true);
  const double expected = 60 * 2.0 * 2.0 / 3.0 * model.contrast_dropout * kSpot / 0.00127;
  EXPECT_NEAR(lost, expected, 4.0 * std::sqrt(expected) + 0.05 * expected);
}

LidarBeams::SubHit Hit(double range_m, double reflectivity, const LidarTarget& target) {
  return {.range_m = range_m, .reflectivity = reflectivity, .target = &target};
}

TEST(LidarEdge, NearEchoesMergeToTheirPowerWeightedMean) {
  LidarTarget front;
  LidarTarget back;
  back.object = SceneObject::kWall;
  std::vector<LidarBeams::SubHit> hits = {Hit(2.5, 0.5, back), Hit(2.0, 0.8, front),
                                          Hit(2.0, 0.8, front)};
  const LidarEcho echo = StrongestEcho(hits, 4, 1.0);
  const double front_power = 2 * 0.8 / 4.0;
  const double back_power = 0.5 / 6.25;
  EXPECT_NEAR(echo.range_m, (2.0 * front_power + 2.5 * back_power) / (front_power + back_power),
              1e-12);
  EXPECT_NEAR(echo.power, (front_power + back_power) / 4.0, 1e-12);
  EXPECT_NEAR(echo.reflectivity, 2.1 / 4.0, 1e-12);
  EXPECT_EQ(echo.truth.object, SceneObject::kBoard);
  EXPECT_EQ(echo.truth.spot_share, 0.5);
  EXPECT_TRUE(echo.truth.mixed);
}

TEST(LidarEdge, TheStrongestOfSeparateEchoesIsReturned) {
  LidarTarget front;
  LidarTarget back;
  back.object = SceneObject::kWall;
  std::vector<LidarBeams::SubHit> hits = {Hit(2.0, 0.1, front), Hit(4.0, 0.9, back),
                                          Hit(4.0, 0.9, back)};
  const LidarEcho echo = StrongestEcho(hits, 3, 1.0);
  EXPECT_EQ(echo.range_m, 4.0);
  EXPECT_EQ(echo.truth.object, SceneObject::kWall);
  EXPECT_FALSE(echo.truth.mixed);
}

// Every spot reported to be on one surface must be: the rays of its corners are cast to check.
TEST(LidarEdge, FindsEveryEdge) {
  const Scene scene = FullRoom();
  const LidarSpot spot = {.aperture_h_m = 0.0127,
                          .aperture_v_m = 0.0095,
                          .divergence_h_rad = 0.003,
                          .divergence_v_rad = 0.0015};
  const auto spots = LidarBeams::Make(scene, spot, 1.0);
  const auto lines = LidarBeams::Make(scene, LidarSpot{}, 1.0);
  ASSERT_TRUE(spots && lines);
  LidarBeams::Scratch scratch;
  Random random(11);
  int whole = 0;
  int edges = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const double azimuth = random.Uniform(-3.14159, 3.14159);
    const double elevation = random.Uniform(-0.4, 0.4);
    const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                    std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    const auto echo = spots->Cast({Eigen::Vector3d::Zero(), direction}, 0.0, scratch);
    ASSERT_TRUE(echo);
    if (echo->truth.spot_share < 1.0) {
      ++edges;
      continue;
    }
    ++whole;
    const Eigen::Vector3d h(-std::sin(azimuth), std::cos(azimuth), 0.0);
    const Eigen::Vector3d v = direction.cross(h);
    // Checks within the outermost sub-rays, as objects hit only by the rim of a spot may be missed.
    for (const double a : {-0.45, 0.45}) {
      for (const double b : {-0.41, 0.41}) {
        const LidarRay corner = {
            a * spot.aperture_h_m * h + b * spot.aperture_v_m * v,
            (direction + a * spot.divergence_h_rad * h + b * spot.divergence_v_rad * v)
                .normalized()};
        const auto at_corner = lines->Cast(corner, 0.0, scratch);
        ASSERT_TRUE(at_corner);
        ASSERT_EQ(at_corner->truth.object, echo->truth.object) << trial;
        ASSERT_EQ(at_corner->truth.index, echo->truth.index) << trial;
      }
    }
  }
  EXPECT_GT(whole, 15000);
  EXPECT_GT(edges, 100);
}

}  // namespace
}  // namespace sextant
