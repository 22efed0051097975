// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/pcd_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <set>

#include "base/random.h"
#include "support/bad_text.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using test::BadText;
using testing::ElementsAre;

using ErrorCode::kParse;
constexpr PcdEncoding kEncodings[] = {PcdEncoding::kAscii, PcdEncoding::kBinary,
                                      PcdEncoding::kBinaryCompressed};

// Values that a float represents exactly.
PointCloud SomeCloud(int points) {
  PointCloud cloud;
  Random random(5);
  for (int i = 0; i < points; ++i) {
    Eigen::Vector3d point;
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = static_cast<float>(random.Uniform(-30.0, 30.0));
    }
    cloud.points.push_back(point);
    cloud.intensity.push_back(static_cast<float>(random.Below(256)));
    cloud.ring.push_back(static_cast<std::uint16_t>(i % 128 * 500));
    cloud.time_s.push_back(static_cast<float>(random.Uniform(0.0, 0.1)));
  }
  return cloud;
}

TEST(Pcd, RoundTripsInEveryEncoding) {
  for (const PcdEncoding encoding : kEncodings) {
    for (const int points : {0, 1, 1000}) {
      const PointCloud cloud = SomeCloud(points);
      const Expected<PointCloud> again = ParsePcd(FormatPcd(cloud, encoding), "f");
      ASSERT_TRUE(again) << again.error().message;
      EXPECT_EQ(again->points, cloud.points);
      EXPECT_EQ(again->intensity, cloud.intensity);
      EXPECT_EQ(again->ring, cloud.ring);
      EXPECT_EQ(again->time_s, cloud.time_s);
    }
  }
}

TEST(Pcd, WritesOnlyWhatThereIs) {
  for (const PcdEncoding encoding : kEncodings) {
    PointCloud cloud = SomeCloud(10);
    cloud.intensity.clear();
    cloud.time_s.clear();
    const Expected<PointCloud> again = ParsePcd(FormatPcd(cloud, encoding), "f");
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->ring, cloud.ring);
    EXPECT_TRUE(again->intensity.empty());
    EXPECT_TRUE(again->time_s.empty());
  }
}

TEST(Pcd, PointsWithoutAReturnAreNaN) {
  PointCloud cloud = SomeCloud(3);
  cloud.points[1].y() = std::numeric_limits<double>::quiet_NaN();
  for (const PcdEncoding encoding : kEncodings) {
    const Expected<PointCloud> again = ParsePcd(FormatPcd(cloud, encoding), "f");
    ASSERT_TRUE(again) << again.error().message;
    ASSERT_EQ(again->points.size(), 3U);
    EXPECT_TRUE(again->points[1].array().isNaN().all());
    EXPECT_EQ(again->points[2], cloud.points[2]);
  }
}

std::string Header(const std::string& fields, const std::string& sizes, const std::string& types,
                   const std::string& counts, int points, const std::string& data) {
  return "VERSION .7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " + types + "\nCOUNT " +
         counts + "\nWIDTH " + std::to_string(points) +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) + "\nDATA " +
         data + "\n";
}

template <class T>
std::string Bytes(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

TEST(Pcd, TakesEveryTypeAndSkipsWhatItDoesNotKnow) {
  const std::string text = Header("x _ y z rgb ring t intensity", "8 1 4 2 4 1 4 8",
                                  "F U F I U U U U", "1 3 1 1 2 1 1 1", 2, "binary") +
                           Bytes(1.5) + "abc" + Bytes(2.5F) + Bytes(std::int16_t{-3}) + "rgbrgbrg" +
                           Bytes(std::uint8_t{200}) + Bytes(std::uint32_t{250'000}) +
                           Bytes(std::uint64_t{65535}) + Bytes(-1.25) + "abc" + Bytes(-2.0F) +
                           Bytes(std::int16_t{300}) + "rgbrgbrg" + Bytes(std::uint8_t{0}) +
                           Bytes(std::uint32_t{99'999'744}) + Bytes(std::uint64_t{1});
  const Expected<PointCloud> cloud = ParsePcd(text, "f");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_THAT(cloud->points,
              ElementsAre(Eigen::Vector3d(1.5, 2.5, -3), Eigen::Vector3d(-1.25, -2, 300)));
  EXPECT_THAT(cloud->ring, ElementsAre(200, 0));
  EXPECT_THAT(cloud->intensity, ElementsAre(65535.0F, 1.0F));
  EXPECT_NEAR(cloud->time_s[0], 250e-6, 1e-15);
  EXPECT_NEAR(cloud->time_s[1], 0.099999744, 1e-15);
}

TEST(Pcd, TimesOfDayCountFromTheEarliest) {
  const std::string text = Header("x y z timestamp", "4 4 4 8", "F F F F", "1 1 1 1", 2, "ascii") +
                           "1 2 3 1600000000.75\n1 2 3 1600000000.5\n";
  const Expected<PointCloud> cloud = ParsePcd(text, "f");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_THAT(cloud->time_s, ElementsAre(0.25, 0.0));
}

TEST(Pcd, AcceptsOldHeadersAndWindowsLineEnds) {
  const Expected<PointCloud> cloud = ParsePcd(
      "# made by hand\r\nFIELDS x y z\r\nSIZE 4 4 4\r\nTYPE F F F\r\nWIDTH 2\r\nHEIGHT 1\r\n"
      "DATA ascii\r\n1 2 3\r\n-nan 1 inf\r\n",
      "f");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points[0], Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(cloud->points[1].array().isNaN().all());
}

// A stream of liblzf written by hand: a byte n < 32 precedes n + 1 literal bytes.
TEST(Pcd, ReadsACompressedStreamThatIsNotOurs) {
  std::string data;
  for (const float value : {1.0F, 4.0F, 2.0F, 5.0F, 3.0F, 6.0F}) data += Bytes(value);
  const std::string packed = std::string(1, static_cast<char>(data.size() - 1)) + data;
  const std::string text = Header("x y z", "4 4 4", "F F F", "1 1 1", 2, "binary_compressed") +
                           Bytes(static_cast<std::uint32_t>(packed.size())) +
                           Bytes(static_cast<std::uint32_t>(data.size())) + packed;
  const Expected<PointCloud> cloud = ParsePcd(text, "f");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_THAT(cloud->points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
}

class BadPcdTest : public testing::TestWithParam<BadText> {};

TEST_P(BadPcdTest, EndsInOneLineThatSaysWhereAndWhat) {
  ExpectRefused(ParsePcd(GetParam().text, "f"), GetParam());
}

std::string Xyz(int points, const std::string& data) {
  return Header("x y z", "4 4 4", "F F F", "1 1 1", points, data);
}

std::string Changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadPcdTest,
    testing::Values(
        BadText{"Empty", "", kParse, "f: expected a PCD file"},
        BadText{"Binary", std::string("\x7f\x45\x4c\x46\x00\x01", 6), kParse,
                "expected a PCD file"},
        BadText{"OnlyData", "DATA ascii\n", kParse, "f:1: the header ends here without a line"},
        BadText{"UnknownLine", "FIELDZ x\n" + Xyz(0, "ascii"), kParse,
                "f:1: unknown line 'FIELDZ' in the header of a PCD file; did you mean 'FIELDS'?"},
        BadText{"FewSizes", Changed(Xyz(0, "ascii"), "4 4 4", "4 4"), kParse,
                "f:3: expected one value for each of the 3 FIELDS, got 2"},
        BadText{"SizeBeforeFields", "SIZE 4\n" + Xyz(0, "ascii"), kParse,
                "f:1: expected one value"},
        BadText{"OddSize", Changed(Xyz(0, "ascii"), "4 4 4", "4 3 4"), kParse,
                "f:3: expected a size of 1, 2, 4 or 8 bytes, got 3"},
        BadText{"SmallFloat", Changed(Xyz(0, "ascii"), "4 4 4", "4 2 4"), kParse,
                "floating point of 2 bytes"},
        BadText{"OddType", Changed(Xyz(0, "ascii"), "F F F", "F X F"), kParse,
                "f:4: expected the types F, U or I, got 'X'"},
        BadText{"FieldTwice", Changed(Xyz(0, "ascii"), "x y z", "x y x"), kParse,
                "f:2: the field 'x' is named twice"},
        BadText{"NoZ", Changed(Xyz(0, "ascii"), "x y z", "x y w"), kParse,
                "FIELDS: expected columns x, y and z; z is missing, the columns are: "},
        BadText{"Encoding", Xyz(0, "asci"), kParse, "f:10: unknown encoding 'asci'; did you mean"},
        BadText{"Contradiction", Changed(Xyz(2, "ascii"), "POINTS 2", "POINTS 3"), kParse,
                "the header is inconsistent: POINTS is 3, but WIDTH x HEIGHT is 2"},
        BadText{"Negative", Changed(Xyz(2, "ascii"), "WIDTH 2", "WIDTH -2"), kParse,
                "f:6: field 2"},
        BadText{"HugeProduct", Changed(Xyz(100000, "ascii"), "HEIGHT 1", "HEIGHT 100000"), kParse,
                "expected at most 1000000000 points"},
        BadText{"AsciiPromise", Xyz(1000000000, "ascii") + "1 2 3\n", kParse,
                "the header states 1000000000 points, but the file has room for at most 1"},
        BadText{"AsciiShort", Xyz(2, "ascii") + "1.0000001 2.0000001 3\n", kParse,
                "the file ends here, expected the 3 values of a point"},
        BadText{"AsciiLong", Xyz(1, "ascii") + "1 2 3\n4 5 6\n", kParse,
                "f:12: expected the end of the file after the 1 points"},
        BadText{"AsciiRow", Xyz(1, "ascii") + "1 2 3 4\n", kParse, "f:11: "},
        BadText{"AsciiWord", Xyz(1, "ascii") + "1 two 3\n", kParse, "f:11: field 2 (y)"},
        BadText{"AsciiRing",
                Header("x y z ring", "4 4 4 2", "F F F U", "1 1 1 1", 1, "ascii") + "1 2 3 -1\n",
                kParse, "f:11: ring: expected a whole number from 0 to 65535, got -1"},
        BadText{"BinaryRing",
                Header("ring x y z", "4 4 4 4", "F F F F", "1 1 1 1", 1, "binary") + Bytes(0.5F) +
                    Bytes(1.0F) + Bytes(1.0F) + Bytes(1.0F),
                kParse, "point 0: ring: expected a whole number from 0 to 65535, got 0.5"},
        BadText{"BinaryShort", Xyz(2, "binary") + std::string(23, 'a'), kParse,
                "the header states 2 points of 12 bytes, 24 bytes in all; the file has 23"},
        BadText{"BinaryLong", Xyz(2, "binary") + std::string(100000, 'a'), kParse,
                "the file has 100000 after its header"},
        BadText{"BinaryPromise", Xyz(1000000000, "binary"), kParse,
                "the header states 1000000000 points"},
        BadText{"CompressedNothing", Xyz(1, "binary_compressed") + "abc", kParse,
                "the file ends before its compressed data"},
        BadText{"CompressedSize",
                Xyz(1, "binary_compressed") + Bytes(std::uint32_t{5}) + Bytes(std::uint32_t{13}) +
                    "abcde",
                kParse, "the compressed data states 13"},
        BadText{"CompressedShort",
                Xyz(1, "binary_compressed") + Bytes(std::uint32_t{6}) + Bytes(std::uint32_t{12}) +
                    "abcde",
                kParse, "stated to have 6 bytes that expand to 12; the file has 5"},
        BadText{"CompressedBomb",
                Xyz(100000000, "binary_compressed") + Bytes(std::uint32_t{5}) +
                    Bytes(std::uint32_t{1200000000}) + "abcde",
                kParse, "stated to have 5 bytes that expand to 1200000000"},
        BadText{"CompressedDamage",
                Xyz(1, "binary_compressed") + Bytes(std::uint32_t{5}) + Bytes(std::uint32_t{12}) +
                    "\xff\xff\xff\xff\xff",
                kParse, "the compressed data is damaged"}),
    [](const auto& bad) { return bad.param.name; });

TEST(Pcd, ReadsTheRealScansOfAVlp16) {
  SEXTANT_REAL_DATA(path, "acfr_vlp16/full/pose2.pcd");
  const Expected<PointCloud> cloud = ReadPcd(path);
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points.size(), 24163U);
  EXPECT_EQ(cloud->points[0], Eigen::Vector3d(-1.2484956F, 2.2013252F, -0.67810601F));
  EXPECT_EQ(cloud->intensity[1], 45.0F);
  EXPECT_EQ(std::set<std::uint16_t>(cloud->ring.begin(), cloud->ring.end()).size(), 16U);
  // Ring 15 of a VLP-16 has an elevation of 15 degrees.
  for (std::size_t i = 0; i < cloud->points.size(); ++i) {
    const Eigen::Vector3d& p = cloud->points[i];
    const double elevation = std::atan2(p.z(), std::hypot(p.x(), p.y()));
    ASSERT_NEAR(elevation, (-15.0 + 2.0 * cloud->ring[i]) * 3.14159265 / 180.0, 0.02) << i;
  }
}

TEST(Pcd, ReadsTheRealScansOfAnOuster) {
  SEXTANT_REAL_DATA(path, "ouster64/lidar_data/pointcloud3.pcd");
  const Expected<PointCloud> cloud = ReadPcd(path);
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points.size(), 65536U);
  EXPECT_EQ(cloud->intensity.size(), 65536U);
  EXPECT_EQ(std::set<std::uint16_t>(cloud->ring.begin(), cloud->ring.end()).size(), 64U);
}

}  // namespace
}  // namespace sextant
