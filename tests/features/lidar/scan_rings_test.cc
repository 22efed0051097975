// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rings/scan_rings.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "base/random.h"
#include "base/units.h"
#include "features/lidar/rings/ring_turns.h"
#include "io/clouds/pcd_file.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"
#include "simulator/scene/everyday_scene.h"
#include "support/real_data.h"

namespace sextant::test {
namespace {

TEST(ScanRings, RefusesWhatHasNoReturn) {
  const Expected<ScanRings> empty = ScanRings::Build({});
  ASSERT_FALSE(empty);
  EXPECT_EQ(empty.error().code, ErrorCode::kMissingData);

  PointCloud cloud;
  cloud.points.assign(100, Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  cloud.points.resize(200, Eigen::Vector3d::Zero());
  const Expected<ScanRings> nothing = ScanRings::Build(cloud);
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::kMissingData);
  EXPECT_NE(nothing.error().message.find("200"), std::string::npos);
}

TEST(ScanRings, RefusesFieldsOfAnotherLength) {
  PointCloud cloud;
  cloud.points.assign(3, Eigen::Vector3d::UnitX());
  cloud.ring = {0, 1};
  const Expected<ScanRings> rings = ScanRings::Build(cloud);
  ASSERT_FALSE(rings);
  EXPECT_EQ(rings.error().code, ErrorCode::kInvalidInput);
}

TEST(ScanRings, OnePointIsOneRing) {
  PointCloud cloud;
  cloud.points = {Eigen::Vector3d::UnitX()};
  const Expected<ScanRings> rings = ScanRings::Build(cloud);
  ASSERT_TRUE(rings);
  EXPECT_EQ(rings->rings(), 1);
  EXPECT_EQ(rings->ring(0).size(), 1U);
}

// Ring numbers that descend with elevation, with gaps, in shuffled order.
TEST(ScanRings, SortsByElevationAndAzimuth) {
  PointCloud cloud;
  for (int azimuth = 0; azimuth < 360; azimuth += 3) {
    for (int ring = 0; ring < 5; ++ring) {
      const double a = ((azimuth * 7) % 360) * kRadPerDeg;
      const double e = (2.0 * ring - 4.0) * kRadPerDeg;
      cloud.points.emplace_back(3.0 * std::cos(e) * std::cos(a), 3.0 * std::cos(e) * std::sin(a),
                                3.0 * std::sin(e));
      cloud.ring.push_back(static_cast<std::uint16_t>(20 - 3 * ring));
    }
  }
  const Expected<ScanRings> rings = ScanRings::Build(cloud);
  ASSERT_TRUE(rings);
  ASSERT_EQ(rings->rings(), 5);
  EXPECT_NEAR(rings->elevation_step_rad(), 2.0 * kRadPerDeg, 1e-9);
  EXPECT_NEAR(rings->azimuth_step_rad(), 3.0 * kRadPerDeg, 1e-9);
  for (int ring = 0; ring < 5; ++ring) {
    ASSERT_EQ(rings->ring(ring).size(), 120U);
    EXPECT_NEAR(rings->ring(ring)[0].point.z(), 3.0 * std::sin((2.0 * ring - 4.0) * kRadPerDeg),
                1e-12);
    for (std::size_t i = 1; i < 120; ++i) {
      EXPECT_LT(rings->ring(ring)[i - 1].azimuth_rad, rings->ring(ring)[i].azimuth_rad);
    }
  }
}

// A room's walls at 4 to 8 m, without the ring numbers: `beam` gives the returns of a ring.
struct Beams {
  std::vector<double> elevations_deg;
  double height_m = 0.0;   // Height of the beams' origin above the cloud's.
  double drift_deg = 0.0;  // Change of the elevations along half a turn.
};

PointCloud RoomSeenBy(const Beams& beams, int columns) {
  PointCloud cloud;
  for (int column = 0; column < columns; ++column) {
    const double a = 2.0 * std::numbers::pi * column / columns;
    for (std::size_t k = 0; k < beams.elevations_deg.size(); ++k) {
      const double e =
          (beams.elevations_deg[k] + beams.drift_deg * std::abs(a / std::numbers::pi - 1.0)) *
          kRadPerDeg;
      // A person half a metre away, walls farther away.
      const double range = column % 50 < 5 ? 0.5 : 4.0 + 4.0 * std::abs(std::sin(2.0 * a));
      cloud.points.emplace_back(range * std::cos(e) * std::cos(a),
                                range * std::cos(e) * std::sin(a),
                                range * std::sin(e) + beams.height_m);
      cloud.ring.push_back(static_cast<std::uint16_t>(k));
    }
  }
  return cloud;
}

std::vector<double> EvenFan(int rings, double step_deg) {
  std::vector<double> fan;
  for (int i = 0; i < rings; ++i) fan.push_back((i - 0.5 * (rings - 1)) * step_deg);
  return fan;
}

// Dense in the middle, as that of an RS-Ruby or a Pandar.
std::vector<double> UnevenFan() {
  std::vector<double> fan;
  for (int i = 0; i < 40; ++i) fan.push_back(-2.0 + 0.1 * i);
  for (int i = 1; i <= 20; ++i) fan.push_back(1.9 + 0.65 * i);
  for (int i = 1; i <= 20; ++i) fan.insert(fan.begin(), -2.0 - 1.15 * i);
  return fan;
}

void ExpectRings(PointCloud cloud, int rings, const char* what) {
  std::vector<std::uint16_t> truth;
  std::swap(truth, cloud.ring);
  const Expected<ScanRings> found = ScanRings::Build(cloud);
  ASSERT_TRUE(found) << what;
  EXPECT_TRUE(found->has_rings()) << what;
  ASSERT_EQ(found->rings(), rings) << what;
  for (int ring = 0; ring < rings; ++ring) {
    for (const RingPoint& point : found->ring(ring)) {
      ASSERT_EQ(truth[static_cast<std::size_t>(point.index)], ring) << what;
    }
  }
}

TEST(ScanRings, AreRecoveredFromElevationsOfEvenAndUnevenFans) {
  ExpectRings(RoomSeenBy({EvenFan(16, 2.0)}, 400), 16, "16");
  ExpectRings(RoomSeenBy({EvenFan(128, 0.2)}, 400), 128, "128");
  ExpectRings(RoomSeenBy({UnevenFan()}, 400), 80, "80, uneven");
}

// Beams 5 cm above the origin: at half a metre, elevations are 6 degrees off. The order of the
// points distinguishes the rings; invalid points keep their place.
TEST(ScanRings, AreRecoveredFromTheOrderOfThePoints) {
  PointCloud by_column = RoomSeenBy({UnevenFan(), 0.05}, 400);
  for (std::size_t i = 0; i < by_column.points.size(); i += 7) {
    by_column.points[i].setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  ExpectRings(by_column, 80, "by column");
  PointCloud by_ring = by_column;
  for (std::size_t i = 0; i < by_ring.points.size(); ++i) {
    const std::size_t from = i % 400 * 80 + i / 400;
    by_ring.points[i] = by_column.points[from];
    by_ring.ring[i] = by_column.ring[from];
  }
  ExpectRings(by_ring, 80, "by ring");
}

// Some converters write a field `ring` of zeros. A single ring keeps its number.
TEST(ScanRings, AreRecoveredWhereTheFieldSaysNothing) {
  PointCloud cloud = RoomSeenBy({EvenFan(16, 2.0)}, 400);
  cloud.ring.assign(cloud.points.size(), 0);
  const Expected<ScanRings> rings = ScanRings::Build(cloud);
  ASSERT_TRUE(rings);
  EXPECT_TRUE(rings->has_rings());
  EXPECT_EQ(rings->rings(), 16);

  PointCloud single = RoomSeenBy({{3.0}}, 400);
  single.ring.assign(single.points.size(), 7);
  const Expected<ScanRings> one = ScanRings::Build(single);
  ASSERT_TRUE(one);
  ASSERT_EQ(one->rings(), 1);
  EXPECT_EQ(one->number(0), 7);
}

// In any order and without invalid points, rings are followed from far returns to near ones.
TEST(ScanRings, AreFollowedWhereBeamsStartBesideTheOrigin) {
  PointCloud cloud = RoomSeenBy({EvenFan(16, 2.0), 0.01}, 400);
  Random random(1);
  for (std::size_t i = 1; i < cloud.points.size(); ++i) {
    const std::size_t other = random.Below(i + 1);
    std::swap(cloud.points[i], cloud.points[other]);
    std::swap(cloud.ring[i], cloud.ring[other]);
  }
  cloud.points.pop_back();
  cloud.ring.pop_back();
  ExpectRings(cloud, 16, "shuffled");
}

// A mirror that tilts the fan by 0.3 degrees while it turns; rings are 0.2 degrees apart.
TEST(ScanRings, AreFollowedAlongTheAzimuthWhereTheFanTilts) {
  PointCloud cloud = RoomSeenBy({EvenFan(64, 0.2), 0.0, 0.3}, 397);
  cloud.points.pop_back();
  cloud.ring.pop_back();
  ExpectRings(cloud, 64, "tilting");
}

// A sensor on its side, in the frame of the vehicle: its rings turn about another axis.
TEST(ScanRings, OfARotatedCloudTurnAboutItsOwnAxis) {
  for (const double tilt_deg : {5.0, 40.0, 90.0, 180.0}) {
    PointCloud cloud = RoomSeenBy({EvenFan(16, 2.0)}, 400);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(tilt_deg * kRadPerDeg, Eigen::Vector3d::UnitX()).toRotationMatrix();
    for (Eigen::Vector3d& point : cloud.points) point = turn * point;
    const Expected<ScanRings> rings = ScanRings::Build(cloud);
    ASSERT_TRUE(rings);
    EXPECT_TRUE(rings->has_rings()) << tilt_deg;
    EXPECT_EQ(rings->rings(), 16) << tilt_deg;
    EXPECT_NEAR(std::abs(rings->axis().dot(turn.col(2))), 1.0, 1e-9) << tilt_deg;
    EXPECT_NEAR(rings->elevation_step_rad(), 2.0 * kRadPerDeg, 1e-9) << tilt_deg;
  }
}

// The points in another order: ascending by `key`, those of one key as they were.
template <typename Key>
PointCloud Sorted(const PointCloud& cloud, Key key) {
  std::vector<std::size_t> order(cloud.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, key);
  PointCloud sorted;
  for (const std::size_t i : order) {
    sorted.points.push_back(cloud.points[i]);
    sorted.ring.push_back(cloud.ring[i]);
  }
  return sorted;
}

double TurnedFrom(double start_deg, const Eigen::Vector3d& point) {
  const double azimuth = std::atan2(point.y(), point.x()) - start_deg * kRadPerDeg;
  return azimuth < 0.0 ? azimuth + 2.0 * std::numbers::pi : azimuth;
}

// A street seen by a moving HDL-64E, whose two blocks are 13 and 20 cm above the origin, written
// ring by ring, each from an azimuth on, counter-clockwise. The motion was removed, a metre in a
// turn from the rear to the rear: rings are wide.
PointCloud StreetFrom(double start_deg, std::uint64_t seed) {
  LidarModel model = *FindLidarModel("hdl64e");
  for (LidarRing& ring : model.rings) {
    ring.origin_height_m = ring.elevation_rad < -8.5 * kRadPerDeg ? 0.13 : 0.2;
  }
  const Scene scene = EverydayScene(EverydayPlace::kStreet, seed);
  PointCloud scan = SimulateScan(scene, model, {.seed = seed})->cloud;
  for (Eigen::Vector3d& point : scan.points) {
    point.x() += 0.5 - TurnedFrom(180.0, point) / (2.0 * std::numbers::pi);
  }
  const PointCloud turn =
      Sorted(scan, [&](std::size_t i) { return TurnedFrom(start_deg, scan.points[i]); });
  return Sorted(turn, [&](std::size_t i) { return 63 - turn.ring[i]; });
}

// Without the returns between two azimuths of every third ring.
PointCloud WithGaps(const PointCloud& cloud, double from_deg, double to_deg) {
  PointCloud kept;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const double turned_deg = TurnedFrom(0.0, cloud.points[i]) * kDegPerRad;
    if (cloud.ring[i] % 3 == 0 && turned_deg > from_deg && turned_deg < to_deg) continue;
    kept.points.push_back(cloud.points[i]);
    kept.ring.push_back(cloud.ring[i]);
  }
  return kept;
}

TEST(ScanRings, AreRecoveredFromTurnsHoweverWideTheyAre) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const PointCloud scan = StreetFrom(0.0, seed);
    ExpectRings(scan, 64, "from azimuth 0 on");
    ExpectRings(StreetFrom(70.0, seed), 64, "from azimuth 70 on");
    ExpectRings(WithGaps(scan, 0.0, 20.0), 64, "without the first returns of some rings");
    ExpectRings(WithGaps(scan, 350.0, 360.0), 64, "without the last returns of some rings");
    PointCloud backwards = scan;
    std::ranges::reverse(backwards.points);
    std::ranges::reverse(backwards.ring);
    ExpectRings(backwards, 64, "clockwise, from the lowest ring up");
  }
}

std::vector<int> TurnsOf(const PointCloud& cloud) {
  std::vector<UnsortedReturn> returns;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    returns.push_back({cloud.points[i].normalized(), cloud.points[i].norm(), i});
  }
  return RingsByTurns(returns);
}

// What elevation(azimuth) sees of a room, azimuths from 0 to the end.
template <typename Elevation>
PointCloud Swept(double end_rad, Elevation elevation) {
  PointCloud cloud;
  for (double a = 0.0; a < end_rad; a += 0.5 * kRadPerDeg) {
    const double range = 6.0 + 2.0 * std::sin(3.0 * a);
    const double e = elevation(a);
    cloud.points.emplace_back(range * std::cos(e) * std::cos(a), range * std::cos(e) * std::sin(a),
                              range * std::sin(e));
  }
  return cloud;
}

TEST(ScanRings, TurnsAreRingsOnlyIfTheyAreLevel) {
  const double turn = 2.0 * std::numbers::pi;
  const auto level = [&](double a) { return -0.3 + 0.01 * std::floor(a / turn); };
  const auto spiral = [&](double a) { return -0.3 + 0.01 * a / turn; };
  const auto rosette = [&](double a) { return 0.4 * std::sin(0.37 * a); };
  const auto woven = [&](double a) { return level(a) + 0.1 * std::sin(2.5 * a); };
  const auto slow_rosette = [&](double a) { return 0.3 * std::sin(0.02 * a); };
  EXPECT_FALSE(TurnsOf(Swept(40.0 * turn, level)).empty());
  EXPECT_TRUE(TurnsOf(Swept(12.0 * turn, level)).empty()) << "too few";
  EXPECT_TRUE(TurnsOf(Swept(40.0 * turn, spiral)).empty());
  EXPECT_TRUE(TurnsOf(Swept(40.0 * turn, rosette)).empty());
  EXPECT_TRUE(TurnsOf(Swept(40.0 * turn, slow_rosette)).empty());
  EXPECT_TRUE(TurnsOf(Swept(40.0 * turn, woven)).empty());
}

TEST(ScanRings, TurnsAreRingsOnlyIfTheyFollowEachOther) {
  const PointCloud scan = StreetFrom(0.0, 1);
  ASSERT_FALSE(TurnsOf(scan).empty());
  const auto sorted = [&](auto key) { return TurnsOf(Sorted(scan, key)); };
  EXPECT_TRUE(sorted([&](std::size_t i) { return TurnedFrom(0.0, scan.points[i]); }).empty())
      << "by column";
  EXPECT_TRUE(sorted([&](std::size_t i) { return 27 * scan.ring[i] % 64; }).empty())
      << "not in the order of elevation";
  Random random(1);
  std::vector<double> any;
  while (any.size() < scan.points.size()) any.push_back(random.Uniform());
  EXPECT_TRUE(sorted([&](std::size_t i) { return any[i]; }).empty()) << "shuffled";
  PointCloud twice = scan;
  twice.points.insert(twice.points.end(), scan.points.begin(), scan.points.end());
  EXPECT_TRUE(TurnsOf(twice).empty()) << "accumulated";
}

TEST(ScanRings, TurnsAreRingsOnlyIfTheyGoRound) {
  PointCloud front;
  for (const Eigen::Vector3d& point : StreetFrom(0.0, 1).points) {
    if (point.x() > std::abs(point.y())) front.points.push_back(point);
  }
  EXPECT_TRUE(TurnsOf(front).empty()) << "cropped to a quarter of each turn";
  PointCloud ground;
  for (double x = 5.0; x < 15.0; x += 0.25) {
    for (double y = -10.0; y < 10.0; y += 0.05) ground.points.emplace_back(x, y, -1.7);
  }
  EXPECT_TRUE(TurnsOf(ground).empty()) << "a grid of heights";
}

// The number of rings with returns in one scan of each sensor.
TEST(ScanRings, OfRealSensorsWithoutARingField) {
  SEXTANT_REAL_DATA(folder, "field/rings");
  struct Sensor {
    const char* name;
    int low;
    int high;
  };
  for (const Sensor& sensor :
       {Sensor{"40p", 38, 40}, Sensor{"64", 64, 64}, Sensor{"qt64", 64, 64},
        Sensor{"vlp16", 15, 16}, Sensor{"xt16", 16, 16}, Sensor{"xt32", 32, 32},
        Sensor{"xt32m", 32, 32}, Sensor{"vlp32", 32, 32}, Sensor{"vls128", 127, 128},
        Sensor{"qt128", 110, 128}, Sensor{"ot128", 114, 128}, Sensor{"at128", 75, 128}}) {
    Expected<PointCloud> cloud = ReadPcd(folder / (std::string(sensor.name) + ".pcd"));
    ASSERT_TRUE(cloud) << cloud.error().message;
    cloud->ring.clear();
    const Expected<ScanRings> rings = ScanRings::Build(*cloud);
    ASSERT_TRUE(rings);
    EXPECT_TRUE(rings->has_rings()) << sensor.name;
    EXPECT_GE(rings->rings(), sensor.low) << sensor.name;
    EXPECT_LE(rings->rings(), sensor.high) << sensor.name;
  }
}

TEST(ScanRings, OfARealSensorWhoseBeamsStartBesideTheOrigin) {
  SEXTANT_REAL_DATA(folder, "field/rs16_yard");
  for (const char* name : {"0001", "0002", "0003", "0004", "0005", "0006"}) {
    const Expected<PointCloud> cloud = ReadPcd(folder / (std::string(name) + ".pcd"));
    ASSERT_TRUE(cloud) << cloud.error().message;
    const Expected<ScanRings> rings = ScanRings::Build(*cloud);
    ASSERT_TRUE(rings);
    EXPECT_EQ(rings->rings(), 16) << name;
    EXPECT_NEAR(rings->azimuth_step_rad(), 0.2 * kRadPerDeg, 0.01 * kRadPerDeg) << name;
  }
}

// Each begins at azimuth 0, the highest first. Returns of a laser beside the axis may have a
// slightly negative azimuth at the beginning of a turn.
TEST(ScanRings, OfKittiAreTheTurnsOfItsFiles) {
  SEXTANT_REAL_DATA(folder, "field/kitti/pcd");
  for (const char* name : {"000000", "000649", "001297", "001946", "002595", "003244", "003892"}) {
    const Expected<PointCloud> cloud = ReadPcd(folder / (std::string(name) + ".pcd"));
    ASSERT_TRUE(cloud) << cloud.error().message;
    const Expected<ScanRings> rings = ScanRings::Build(*cloud);
    ASSERT_TRUE(rings);
    EXPECT_TRUE(rings->has_rings()) << name;
    ASSERT_EQ(rings->rings(), 64) << name;
    EXPECT_NEAR(rings->azimuth_step_rad(), 0.18 * kRadPerDeg, 0.01 * kRadPerDeg) << name;
    std::vector<int> turns(1, 0);
    for (std::size_t i = 1; i < cloud->points.size(); ++i) {
      const Eigen::Vector3d& last = cloud->points[i - 1];
      const Eigen::Vector3d& now = cloud->points[i];
      const bool begins = now.x() > 0.0 && last.y() < 0.0 && now.y() >= 0.0;
      turns.push_back(turns.back() + (begins ? 1 : 0));
    }
    int others = 0;
    for (int ring = 0; ring < 64; ++ring) {
      for (const RingPoint& point : rings->ring(ring)) {
        others += turns[static_cast<std::size_t>(point.index)] != 63 - ring ? 1 : 0;
      }
    }
    EXPECT_LE(others, 10) << name;
  }
}

}  // namespace
}  // namespace sextant::test
