// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/cloud_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "io/clouds/cloud_builder.h"
#include "support/bad_text.h"
#include "support/real_data.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using test::BadText;
using testing::ElementsAre;

using ErrorCode::kParse;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::string Floats(const std::vector<float>& values) {
  std::string bytes;
  for (const float value : values) {
    const auto raw = std::bit_cast<std::array<char, 4>>(value);
    bytes.append(raw.data(), raw.size());
  }
  return bytes;
}

TEST(CloudFile, KittiIsFourFloatsAPoint) {
  const Expected<PointCloud> cloud =
      ParseCloud(Floats({1, 2, 3, 0.5F, 4, 5, 6, 0.25F}), "000000.BIN");
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->points.size(), 2U);
  EXPECT_EQ(cloud->points[1], Eigen::Vector3d(4, 5, 6));
  EXPECT_THAT(cloud->intensity, ElementsAre(0.5F, 0.25F));
}

TEST(CloudFile, CsvTakesColumnsInAnyOrder) {
  const Expected<PointCloud> cloud = ParseCloud(
      "ring, z,Y,x,intensity,time,azimuth\n0,-1,2,3,9,0.5,10\n1,1,2,nan,9,0.75,20\n", "a.csv");
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->points.size(), 2U);
  EXPECT_EQ(cloud->points[0], Eigen::Vector3d(3, 2, -1));
  EXPECT_TRUE(cloud->points[1].array().isNaN().all());
  EXPECT_THAT(cloud->ring, ElementsAre(0, 1));
  EXPECT_THAT(cloud->time_s, ElementsAre(0.5, 0.75));
}

// VLP-16 fires laser 0 at -15 deg, laser 1 at +1 deg, laser 2 at -13 deg, laser 3 at +3 deg.
TEST(CloudFile, VeloViewRingsAndTimesAreConverted) {
  const Expected<PointCloud> cloud = ParseCloud(
      "\"Points_m_XYZ:0\",\"Points_m_XYZ:1\",\"Points_m_XYZ:2\",\"intensity\",\"laser_id\","
      "\"azimuth\",\"distance_m\",\"adjustedtime\",\"timestamp\",\"vertical_angle\"\n"
      "10,0,-2.679,1,0,9000,10,1400000100,1,-15\n10,0,0.175,2,1,9000,10,1400000102,1,1\n"
      "10,0,-2.309,3,2,9000,10,1400000104,1,-13\n10,0,0.524,4,3,9000,10,1400000106,1,3\n",
      "scan.csv");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_THAT(cloud->ring, ElementsAre(0, 2, 1, 3));
  ASSERT_EQ(cloud->time_s.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(cloud->time_s[i], 2e-6 * static_cast<double>(i), 1e-9);
  }
}

PointCloud OnePointARing(const std::vector<int>& rings, const std::vector<double>& heights) {
  PointCloud cloud;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    cloud.points.emplace_back(5.0, 1.0, heights[i]);
    cloud.ring.push_back(static_cast<std::uint16_t>(rings[i]));
  }
  return cloud;
}

TEST(OrderRings, RingsNumberedFromAboveAreReversed) {
  PointCloud cloud = OnePointARing({0, 1, 3}, {3, 2, 1});
  OrderRings(cloud);
  EXPECT_THAT(cloud.ring, ElementsAre(3, 2, 0));
}

TEST(OrderRings, AscendingRingsKeepTheirGaps) {
  PointCloud cloud = OnePointARing({2, 5, 9}, {1, 2, 3});
  OrderRings(cloud);
  EXPECT_THAT(cloud.ring, ElementsAre(2, 5, 9));
}

TEST(OrderRings, RingsWithoutReturnsAreNotMistakenForOthers) {
  PointCloud cloud = OnePointARing({0, 1, 2, 3, 7}, {1, 3, 2, 4, kNaN});
  OrderRings(cloud);
  EXPECT_THAT(cloud.ring, ElementsAre(0, 2, 1, 3, 4));
}

TEST(CloudFile, TimesSince1970CountFromTheFirst) {
  const Expected<PointCloud> cloud = ParseCloud(
      "x,y,z,timestamp\n1,1,1,1600000000.25\n1,1,1,1600000000.5\nnan,1,1,nan\n", "a.csv");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_THAT(cloud->time_s, ElementsAre(0.0, 0.25, 0.0));
}

TEST(CloudFile, IsReadFromTheDisk) {
  const std::filesystem::path path = test::TestFolder() / "scan.csv";
  test::WriteText(path, "x,y,z\n1,2,3\n");
  const Expected<PointCloud> cloud = ReadCloud(path);
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points.size(), 1U);
  EXPECT_EQ(ReadCloud(path.parent_path() / "none.csv").error().code, ErrorCode::kIo);
}

class BadCloudTest : public testing::TestWithParam<BadText> {};

TEST_P(BadCloudTest, EndsInOneLineThatSaysWhereAndWhat) {
  const std::string extension = std::string(GetParam().name).starts_with("Kitti") ? ".bin" : ".csv";
  ExpectRefused(ParseCloud(GetParam().text, "s" + extension), GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadCloudTest,
    testing::Values(
        BadText{"KittiEmpty", "", kParse, "s.bin: byte 0: the file ends within a point"},
        BadText{"KittiCut", std::string(31, 'a'), kParse, "s.bin: byte 31: the file ends within"},
        BadText{"Empty", "", kParse, "s.csv:1: the file ends here, expected a header line"},
        BadText{"OtherNames", "a,b,c\n4,5,6\n", kParse,
                "s.csv:1: expected columns x, y and z; x is missing, the columns are: a, b, c"},
        BadText{"TwoNumbers", "1,2\n4,5\n", kParse, "s.csv:1: expected x, y and z in each line"},
        BadText{"Millimetres", "1000,200,300\n2000,300,0\n", ErrorCode::kInvalidInput,
                "are in metres"},
        BadText{"NoZ", "x,y\n1,2\n", kParse, "z is missing"},
        BadText{"TwiceX", "x,y,z,X\n", kParse, "s.csv:1: the column 'X' appears twice"},
        BadText{"NoPoints", "x,y,z\n", kParse, "expected points after the header"},
        BadText{"ShortRow", "x,y,z\n1,2\n", kParse,
                "s.csv:2: expected 3 values as in the header, got 2 fields"},
        BadText{"NotANumber", "x,y,z\n1,2,3\n1,two,3\n", kParse,
                "s.csv:3: field 2 (y): expected a number, got 'two'"},
        BadText{"HalfARing", "x,y,z,ring\n1,2,3,0.5\n", kParse,
                "s.csv:2: ring: expected a whole number from 0 to 65535, got 0.5"},
        BadText{"NaNTime", "x,y,z,time\n1,2,3,nan\n", ErrorCode::kNonFinite,
                "s.csv:2: time: expected a finite number"},
        BadText{"EndlessLine", "x,y,z\n" + std::string(1'000'000, ','), kParse,
                "s.csv:2: expected at most 1000 fields in a line"},
        BadText{"EndlessNumber", "x,y,z\n1,2," + std::string(1'000'000, '7') + "e\n", kParse,
                "s.csv:2: field 3 (z): expected a number, got '7777"}),
    [](const auto& bad) { return bad.param.name; });

// The rings of an Ouster are numbered from above, so their numbers are reversed.
TEST(CloudFile, ReadsRealPcdWithRingsFromTheLowest) {
  SEXTANT_REAL_DATA(folder, "ouster64");
  int scans = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".pcd") continue;
    ++scans;
    const Expected<PointCloud> cloud = ReadCloud(entry.path());
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_EQ(cloud->ring.size(), cloud->points.size());
    double low = 0.0;
    double high = 0.0;
    for (std::size_t i = 0; i < cloud->points.size(); ++i) {
      const Eigen::Vector3d& p = cloud->points[i];
      if (!p.allFinite() || p.norm() < 0.1) continue;
      (cloud->ring[i] < 32 ? low : high) += std::atan2(p.z(), std::hypot(p.x(), p.y()));
    }
    EXPECT_LT(low, 0.0);
    EXPECT_GT(high, 0.0);
  }
  EXPECT_EQ(scans, 3);
}

TEST(CloudFile, AnUnknownExtensionGivesTheKnownOnes) {
  const Expected<PointCloud> cloud = ParseCloud("anything", "scan.obj");
  ASSERT_FALSE(cloud);
  EXPECT_THAT(cloud.error().message, testing::HasSubstr(".ply"));
}

TEST(CloudName, FormsThatAreReadAreScansByTheirExtension) {
  for (const char* name : {"a.pcd", "a.ply", "a.las", "a.npy", "a.bin", "a.csv", "a.xyz", "a.pts",
                           "a.asc", "a.tsv", "top/A.PCD"}) {
    EXPECT_TRUE(IsCloudName(name)) << name;
  }
  for (const char* name : {"notes.txt", "a.png", "a.yaml", "pcd", "a.pcd.gz", ""}) {
    EXPECT_FALSE(IsCloudName(name)) << name;
  }
}

}  // namespace
}  // namespace sextant
