// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rings/scan_rings.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/random.h"
#include "base/units.h"
#include "io/clouds/pcd_file.h"
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
  double height_m = 0.0;   // Of the beams' origin above the cloud's.
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
// points tells rings apart, invalid points keep their place.
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

}  // namespace
}  // namespace sextant::test
