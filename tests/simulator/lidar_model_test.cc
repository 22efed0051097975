// SPDX-License-Identifier: Apache-2.0
#include "simulator/lidar/lidar_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/units.h"

namespace sextant {
namespace {

LidarModel Find(const char* name) {
  const Expected<LidarModel> model = FindLidarModel(name);
  EXPECT_TRUE(model) << model.error().message;
  return model.value_or(LidarModel{});
}

TEST(LidarModel, EveryModelIsValidAndNamesItsSource) {
  for (const std::string& name : LidarModelNames()) {
    const Expected<LidarModel> model = FindLidarModel(name);
    ASSERT_TRUE(model) << name;
    EXPECT_EQ(model->name, name);
    const Expected<void> valid = ValidateLidarModel(*model);
    EXPECT_TRUE(valid) << valid.error().message;
    EXPECT_FALSE(model->title.empty()) << name;
    EXPECT_FALSE(model->source.empty()) << name;
    EXPECT_FALSE(model->approximations.empty()) << name;
  }
}

TEST(LidarModel, AnUnknownNameSuggestsTheNearest) {
  const Expected<LidarModel> model = FindLidarModel("vlp-16");
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().code, ErrorCode::kUnknownName);
  EXPECT_THAT(model.error().message, testing::HasSubstr("vlp16"));
}

struct Sheet {
  const char* name;
  std::size_t rings;
  int columns;
  double lowest_deg;
  double highest_deg;
};

TEST(LidarModel, RingElevationsMatchTheDataSheets) {
  const Sheet sheets[] = {
      {"vlp16", 16, 1808, -15.0, 15.0},    {"hdl32e", 32, 2170, -30.67, 10.67},
      {"hdl64e", 64, 2083, -24.33, 2.0},   {"os1_64", 64, 1024, -16.61, 16.61},
      {"os1_128", 128, 1024, -22.5, 22.5}, {"pandar40p", 40, 1800, -25.0, 15.0}};
  for (const Sheet& sheet : sheets) {
    const LidarModel model = Find(sheet.name);
    ASSERT_EQ(model.rings.size(), sheet.rings) << sheet.name;
    EXPECT_EQ(ColumnCount(model), sheet.columns) << sheet.name;
    EXPECT_NEAR(model.rings.front().elevation_rad, sheet.lowest_deg * kRadPerDeg, 1e-4)
        << sheet.name;
    EXPECT_NEAR(model.rings.back().elevation_rad, sheet.highest_deg * kRadPerDeg, 1e-4)
        << sheet.name;
    for (const LidarRing& ring : model.rings) {
      EXPECT_LT(ring.firing_time_s, model.column_period_s) << sheet.name;
    }
  }
}

// Rows of the tables in the VLP-16's, the HDL-32E's and the Pandar40P's manuals.
TEST(LidarModel, SelectedLasersMatchTheManuals) {
  const LidarModel vlp = Find("vlp16");
  EXPECT_NEAR(vlp.rings[8].elevation_rad, 1.0 * kRadPerDeg, 1e-12);  // Laser 1, fired second.
  EXPECT_NEAR(vlp.rings[8].firing_time_s, 2.304e-6, 1e-12);
  EXPECT_NEAR(vlp.rings[0].origin_height_m, 0.0112, 5e-5);
  EXPECT_NEAR(vlp.rings[15].origin_height_m, -0.0112, 5e-5);
  EXPECT_NEAR(vlp.rings[5].origin_height_m, 0.0037, 5e-5);
  const LidarModel hdl = Find("hdl32e");
  EXPECT_NEAR(hdl.rings[16].elevation_rad, -9.33 * kRadPerDeg, 1e-4);  // Laser 1, fired second.
  EXPECT_NEAR(hdl.rings[16].firing_time_s, 1.152e-6, 1e-12);
  const LidarModel pandar = Find("pandar40p");
  EXPECT_NEAR(pandar.rings[40 - 12].elevation_rad, 0.0, 1e-12);  // Channel 12.
  EXPECT_NEAR(pandar.rings[40 - 12].azimuth_offset_rad, 1.042 * kRadPerDeg, 1e-12);
  EXPECT_NEAR(pandar.rings[40 - 7].azimuth_offset_rad, -3.125 * kRadPerDeg, 1e-12);
  EXPECT_NEAR(pandar.rings[40 - 8].azimuth_offset_rad, 5.208 * kRadPerDeg, 1e-12);
  EXPECT_NEAR(pandar.rings[40 - 6].elevation_rad, 2.0 * kRadPerDeg, 1e-12);
}

TEST(LidarModel, VelodyneLasersFireOneByOneExceptInTwoBlocks) {
  for (const char* name : {"vlp16", "hdl32e"}) {
    const LidarModel model = Find(name);
    std::set<double> times;
    for (const LidarRing& ring : model.rings) times.insert(ring.firing_time_s);
    EXPECT_EQ(times.size(), model.rings.size()) << name;
  }
}

TEST(LidarModel, RejectsImpossibleModels) {
  const auto refused = [](auto change) {
    LidarModel model = Find("vlp16");
    change(model);
    const Expected<void> valid = ValidateLidarModel(model);
    EXPECT_FALSE(valid);
    return valid ? std::string() : valid.error().message;
  };
  EXPECT_THAT(refused([](LidarModel& m) { m.range_sigma_m = -0.01; }),
              testing::HasSubstr("range_sigma_m"));
  EXPECT_THAT(
      refused([](LidarModel& m) { m.max_range_m = std::numeric_limits<double>::quiet_NaN(); }),
      testing::HasSubstr("max_range_m"));
  EXPECT_THAT(refused([](LidarModel& m) { m.rings.clear(); }), testing::HasSubstr("rosette"));
  EXPECT_THAT(refused([](LidarModel& m) { std::swap(m.rings[3], m.rings[4]); }),
              testing::HasSubstr("ring 4"));
  EXPECT_THAT(refused([](LidarModel& m) { m.column_period_s = 0.0; }),
              testing::HasSubstr("column"));
  EXPECT_THAT(refused([](LidarModel& m) { m.column_period_s = 1e-12; }),
              testing::HasSubstr("million"));
  EXPECT_THAT(refused([](LidarModel& m) { m.dropout = 1.5; }), testing::HasSubstr("probability"));
  EXPECT_THAT(refused([](LidarModel& m) { m.min_range_m = 200.0; }),
              testing::HasSubstr("min_range_m"));
}

}  // namespace
}  // namespace sextant
