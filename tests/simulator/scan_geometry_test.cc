// SPDX-License-Identifier: Apache-2.0
// Positions of points without noise.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "simulator/lidar/scan.h"
#include "support/lidar_scenes.h"

namespace sextant {
namespace {

using test::FullRoom;
using test::Model;
using test::Noiseless;
using test::Scan;

constexpr double kPi = std::numbers::pi;

// Distance from the surface of a block with bounds +-half, for points that are on or near it.
double BlockDistance(const Eigen::Vector3d& point, const Eigen::Vector3d& half) {
  return (point.cwiseAbs() - half).maxCoeff();
}

// Distance of a point from its stated surface, by the definition of the object.
double SurfaceDistance(const Scene& scene, const Eigen::Vector3d& point_in_lidar, double time_s,
                       const PointTruth& truth) {
  const Eigen::Vector3d point = scene.lidar.world_from_lidar * point_in_lidar;
  const auto index = static_cast<std::size_t>(truth.index);
  switch (truth.object) {
    case SceneObject::kBoard: {
      const SceneBoard& board = scene.boards[index];
      Eigen::Vector3d p = BoardPoseAt(board, time_s).Inverse() * point;
      const Eigen::Vector3d half(0.5 * board.board.top_right_m, 0.5 * board.board.right_bottom_m,
                                 0.5 * board.board.thickness_m);
      p.z() -= half.z();
      const double outer = BlockDistance(p, half);
      for (const RoundHole& round : board.board.round_holes) {
        const double inside = round.radius_m - (p.head<2>() - round.center_in_board_m).norm();
        if (inside > 1e-9) return inside;
      }
      if (!board.board.hole) return outer;
      const BoardHole& hole = *board.board.hole;
      const Eigen::Vector2d from_hole = (p.head<2>() - hole.center_in_board_m).cwiseAbs() -
                                        0.5 * Eigen::Vector2d(hole.width_m, hole.height_m);
      return from_hole.maxCoeff() < -1e-9 ? -from_hole.maxCoeff() : outer;
    }
    case SceneObject::kWall: {
      const SceneWall& wall = scene.walls[index];
      return BlockDistance(wall.world_from_wall.Inverse() * point,
                           {0.5 * wall.width_m, 0.5 * wall.height_m, 0.0});
    }
    case SceneObject::kBox: {
      const SceneBox& box = scene.boxes[index];
      return BlockDistance(box.world_from_box.Inverse() * point, 0.5 * box.size_m);
    }
    case SceneObject::kCylinder: {
      const SceneCylinder& cylinder = scene.cylinders[index];
      const Eigen::Vector3d p = point - cylinder.base_in_world;
      return std::max({p.head<2>().norm() - cylinder.radius_m, -p.z(), p.z() - cylinder.height_m});
    }
  }
  return 1.0;
}

class EveryModel : public testing::TestWithParam<std::string> {};

TEST_P(EveryModel, PutsEveryPointOnItsSurface) {
  Scene scene = FullRoom();
  scene.boards[1].swing =
      Swing{.axis_in_world = {1.0, 0.0, 0.0}, .amplitude_rad = 0.2, .period_s = 1.1};
  const LidarModel model = Model(GetParam());
  for (const bool divergence : {false, true}) {
    ScanOptions options = Noiseless();
    options.divergence = divergence;
    options.start_time_s = 0.7;
    const SimulatedScan scan = Scan(scene, model, options);
    std::map<SceneObject, int> seen;
    ASSERT_EQ(scan.truth.size(), scan.cloud.points.size());
    for (std::size_t i = 0; i < scan.truth.size(); ++i) {
      if (scan.truth[i].spot_share < 1.0) continue;
      ++seen[scan.truth[i].object];
      ASSERT_NEAR(SurfaceDistance(scene, scan.cloud.points[i],
                                  options.start_time_s + scan.cloud.time_s[i], scan.truth[i]),
                  0.0, 1e-9)
          << "point " << i << " object " << static_cast<int>(scan.truth[i].object);
    }
    // A rosette looks forward only, away from the box and the person.
    EXPECT_EQ(seen.size(), model.rosette ? 2U : 4U);
  }
}

TEST_P(EveryModel, EveryBeamInAClosedRoomReturns) {
  const LidarModel model = Model(GetParam());
  ScanOptions options = Noiseless();
  LidarModel near_sighted = model;
  near_sighted.min_range_m = 0.0;
  const auto beams =
      static_cast<std::size_t>(ColumnCount(model)) * std::max<std::size_t>(model.rings.size(), 1);
  EXPECT_EQ(Scan(FullRoom(), near_sighted, options).cloud.points.size(), beams);
  options.divergence = true;
  EXPECT_EQ(Scan(FullRoom(), near_sighted, options).cloud.points.size(), beams);
}

INSTANTIATE_TEST_SUITE_P(Lidar, EveryModel, testing::ValuesIn(LidarModelNames()),
                         [](const auto& of) { return of.param; });

double WrapAngle(double angle) { return std::remainder(angle, 2.0 * kPi); }

TEST(ScanGeometry, RingsAndAzimuthsMatchTheModel) {
  const LidarModel model = Model("pandar40p");
  const SimulatedScan scan = Scan(FullRoom(), model, Noiseless());
  ASSERT_GT(scan.cloud.points.size(), 1000U);
  for (std::size_t i = 0; i < scan.cloud.points.size(); ++i) {
    const Eigen::Vector3d& p = scan.cloud.points[i];
    const LidarRing& ring = model.rings[scan.cloud.ring[i]];
    ASSERT_NEAR(std::atan2(p.z(), p.head<2>().norm()), ring.elevation_rad, 1e-12);
    const double turned = 2.0 * kPi * scan.cloud.time_s[i] / model.turn_period_s;
    const double azimuth = model.start_azimuth_rad - turned + ring.azimuth_offset_rad;
    ASSERT_NEAR(WrapAngle(std::atan2(p.y(), p.x()) - azimuth), 0.0, 1e-12);
  }
}

TEST(ScanGeometry, BeamOriginsMatchTheManual) {
  const LidarModel vlp = Model("vlp16");
  const SimulatedScan scan = Scan(FullRoom(), vlp, Noiseless());
  ASSERT_GT(scan.cloud.points.size(), 1000U);
  for (std::size_t i = 0; i < scan.cloud.points.size(); ++i) {
    const Eigen::Vector3d& p = scan.cloud.points[i];
    const LidarRing& ring = vlp.rings[scan.cloud.ring[i]];
    ASSERT_NEAR(std::atan2(p.z() - ring.origin_height_m, p.head<2>().norm()), ring.elevation_rad,
                1e-12);
  }
}

TEST(ScanGeometry, TheRosetteFillsItsCone) {
  const SimulatedScan scan = Scan(FullRoom(), Model("livox"), Noiseless());
  EXPECT_TRUE(scan.cloud.ring.empty());
  int outer = 0;
  int inner = 0;
  for (const Eigen::Vector3d& p : scan.cloud.points) {
    const double angle = std::atan2(p.tail<2>().norm(), p.x());
    ASSERT_LE(angle, 19.2 * kPi / 180.0 + 1e-12);
    (angle > 9.6 * kPi / 180.0 ? outer : inner) += 1;
  }
  // Sum of two rotating phasors of equal length: |sum| is at most half of its maximum with
  // probability 1/3.
  const double share = static_cast<double>(inner) / (inner + outer);
  EXPECT_NEAR(share, 1.0 / 3.0, 0.01);
}

// A board rotates about its corner while the beam passes over it: its pose at a point's time must
// explain the point, and its pose at the start must not.
TEST(ScanGeometry, AMovingBoardIsDistorted) {
  Scene scene;
  scene.boards = {test::PlainBoard(test::Facing({2.0, 0.0, 0.0}, {1.0, 0.0, 0.0}), 1.0, 1.0)};
  scene.boards[0].swing =
      Swing{.axis_in_world = Eigen::Vector3d::UnitY(), .amplitude_rad = 0.5, .period_s = 1.0};
  // A slow revolution of 2 s, of which the beam takes 1/20 to pass the board.
  LidarModel model = Model("vlp16");
  model.turn_period_s = 2.0;
  model.column_period_s *= 20.0;
  const SimulatedScan scan = Scan(scene, model, Noiseless());
  ASSERT_GT(scan.cloud.points.size(), 1000U);
  double off_at_rest = 0.0;
  for (std::size_t i = 0; i < scan.cloud.points.size(); ++i) {
    const Rigid3d now = BoardPoseAt(scene.boards[0], scan.cloud.time_s[i]);
    ASSERT_NEAR((now.Inverse() * scan.cloud.points[i]).z(), 0.0, 1e-9);
    const Rigid3d then = BoardPoseAt(scene.boards[0], scan.cloud.time_s[0]);
    off_at_rest = std::max(off_at_rest, std::abs((then.Inverse() * scan.cloud.points[i]).z()));
  }
  EXPECT_GT(off_at_rest, 0.05);
}

TEST(ScanGeometry, BoardsOccludeExceptThroughRoundHoles) {
  Scene scene;
  scene.boards = {test::PlainBoard(test::Facing({2.0, 0.0, 0.0}, {1.0, 0.0, 0.0}), 1.0, 1.0)};
  scene.boards[0].board.round_holes = {{.radius_m = 0.2}};
  scene.walls = {test::Wall("behind", test::Facing({4.0, 0.0, 0.0}, {1.0, 0.0, 0.0}), 8.0, 4.0)};
  const SimulatedScan scan = Scan(scene, Model("os1_64"), Noiseless());
  int through = 0;
  for (std::size_t i = 0; i < scan.cloud.points.size(); ++i) {
    const Eigen::Vector3d& p = scan.cloud.points[i];
    const Eigen::Vector2d at_board = p.tail<2>() * (2.0 / p.x());
    if (scan.truth[i].object == SceneObject::kBoard) {
      ASSERT_GT(at_board.norm(), 0.2 - 0.01);
    } else if (at_board.cwiseAbs().maxCoeff() < 0.49) {
      ASSERT_LT(at_board.norm(), 0.2 + 0.01);
      ++through;
    }
  }
  EXPECT_GT(through, 100);
}

TEST(ScanGeometry, BoardsOccludeExceptThroughHoles) {
  Scene scene;
  scene.boards = {test::PlainBoard(test::Facing({2.0, 0.0, 0.0}, {1.0, 0.0, 0.0}), 1.0, 1.0)};
  scene.boards[0].board.hole = BoardHole{.width_m = 0.4, .height_m = 0.4};
  scene.walls = {test::Wall("behind", test::Facing({4.0, 0.0, 0.0}, {1.0, 0.0, 0.0}), 8.0, 4.0)};
  const SimulatedScan scan = Scan(scene, Model("os1_64"), Noiseless());
  int through = 0;
  for (std::size_t i = 0; i < scan.cloud.points.size(); ++i) {
    const Eigen::Vector3d& p = scan.cloud.points[i];
    // Beams start 12 mm from the origin along their azimuth, which shifts their intersection with x
    // = 2.
    const Eigen::Vector2d at_board = p.tail<2>() * (2.0 / p.x());
    const double size = at_board.cwiseAbs().maxCoeff();
    if (scan.truth[i].object == SceneObject::kBoard) {
      ASSERT_GT(size, 0.2 - 0.01);
      ASSERT_LT(size, 0.5 + 0.01);
    } else {
      ASSERT_TRUE(size < 0.2 + 0.01 || size > 0.5 - 0.01);
      if (size < 0.2) ++through;
    }
  }
  // 0.4 m at 2 m are 11.4 degrees, in steps of 0.35 and of 0.527 degrees.
  EXPECT_NEAR(through, (11.42 / 0.3516) * (11.42 / 0.5273), 60);
}

}  // namespace
}  // namespace sextant
