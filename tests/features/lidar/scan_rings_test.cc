// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/scan_rings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/units.h"

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

}  // namespace
}  // namespace sextant::test
