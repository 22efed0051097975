// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/ply_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "support/bad_text.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using test::BadText;

using ErrorCode::kParse;

template <class Number>
std::string Bytes(Number value, bool big_endian) {
  std::string bytes(sizeof(value), '\0');
  std::memcpy(bytes.data(), &value, sizeof(value));
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string Header(const std::string& format, const std::string& count) {
  return "ply\r\nformat " + format +
         " 1.0\r\ncomment made by hand\nelement camera 1\nproperty list uchar int skipped\n"
         "element vertex " +
         count +
         "\nproperty double x\nproperty float y\nproperty float z\nproperty uchar red\n"
         "property float scalar_Intensity\nproperty ushort ring\nproperty uint t\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string Binary(bool big) {
  std::string text = Header(big ? "binary_big_endian" : "binary_little_endian", "2");
  text += Bytes<std::uint8_t>(2, big) + Bytes(7, big) + Bytes(8, big);
  for (int i = 0; i < 2; ++i) {
    text += Bytes(1.5 + i, big) + Bytes(2.5F, big) + Bytes(-3.25F, big) + "r" + Bytes(0.5F, big) +
            Bytes(static_cast<std::uint16_t>(300), big) +
            Bytes(2'000'000U * static_cast<unsigned>(i), big);
  }
  return text;
}

void ExpectBothPoints(const Expected<PointCloud>& cloud) {
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->points.size(), 2U);
  EXPECT_EQ(cloud->points[0], Eigen::Vector3d(1.5, 2.5, -3.25));
  EXPECT_EQ(cloud->points[1], Eigen::Vector3d(2.5, 2.5, -3.25));
  EXPECT_EQ(cloud->intensity, std::vector<float>({0.5F, 0.5F}));
  EXPECT_EQ(cloud->ring, std::vector<std::uint16_t>({300, 300}));
  EXPECT_EQ(cloud->time_s, std::vector<double>({0.0, 2'000'000 * 1e-9}));
}

TEST(PlyFile, EveryEncodingGivesTheSameCloud) {
  ExpectBothPoints(ParsePly(Binary(false), "f"));
  ExpectBothPoints(ParsePly(Binary(true), "f"));
  ExpectBothPoints(ParsePly(Header("ascii", "2") + "2 7 8\n1.5 2.5 -3.25 114 0.5 300 0\n"
                                                   "2.5 2.5 -3.25 114 0.5 300 2000000",
                            "f"));
}

TEST(PlyFile, CoordinateThatIsNotFiniteIsARayWithoutReturn) {
  const Expected<PointCloud> cloud = ParsePly(
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n1 nan 3\n1 2 inf\n",
      "f");
  ASSERT_TRUE(cloud) << cloud.error().message;
  for (const Eigen::Vector3d& point : cloud->points) EXPECT_TRUE(point.array().isNaN().all());
}

TEST(PlyFile, EveryTruncationIsRefused) {
  for (const bool big : {false, true}) {
    const std::string whole = Binary(big);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const Expected<PointCloud> cloud = ParsePly(whole.substr(0, size), "f");
      ASSERT_FALSE(cloud) << size;
      EXPECT_THAT(cloud.error().message, testing::StartsWith("f:"));
    }
  }
}

class BadPlyTest : public testing::TestWithParam<BadText> {};

TEST_P(BadPlyTest, EndsInOneLineThatSaysWhereAndWhat) {
  ExpectRefused(ParsePly(GetParam().text, "s.ply"), GetParam());
}

std::string Xyz(const std::string& count, const std::string& rows) {
  return "ply\nformat ascii 1.0\nelement vertex " + count +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + rows;
}

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadPlyTest,
    testing::Values(
        BadText{"Empty", "", kParse, "s.ply:1: expected 'ply'"},
        BadText{"NoFormat", "ply\nelement vertex 1\n", kParse, "s.ply:2: expected 'format'"},
        BadText{"UnknownFormat", "ply\nformat zip 1.0\n", kParse,
                "s.ply:2: expected 'format', then"},
        BadText{"NoEnd", "ply\nformat ascii 1.0\nelement vertex 1\n", kParse,
                "s.ply:3: the header ends here, expected 'end_header'"},
        BadText{"UnknownType", "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n", kParse,
                "s.ply:4: unknown type 'half'"},
        BadText{"ListOfReals",
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\n", kParse,
                "s.ply:4: expected a length of an integer type"},
        BadText{"EndlessLine", "ply\nformat ascii 1.0\ncomment " + std::string(100'000, 'x'),
                kParse, "s.ply:3: expected a line of at most 1000 bytes"},
        BadText{"NegativeCount", Xyz("-1", ""), kParse,
                "s.ply:3: field 3 (count): expected a whole number"},
        BadText{"LyingCount", Xyz("4000000000", "1 2 3\n"), kParse,
                "s.ply:8: vertex 0: the header states 4000000000 rows, but the 6 bytes that follow "
                "have "
                "room for 1"},
        BadText{"OneRowMissing", Xyz("2", "1.25 2.25 3.25\n"), kParse,
                "s.ply:9: vertex 1: x: the file ends here"},
        BadText{"NotANumber", Xyz("1", "1 two 3"), kParse,
                "s.ply:8: vertex 0: y: expected a number, got 'two'"},
        BadText{"NoZ",
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
                "y\nend_header\n1 2\n",
                kParse, "s.ply: element vertex: expected columns x, y and z; z is missing"},
        BadText{"NoVertex", "ply\nformat ascii 1.0\nend_header\n", kParse,
                "s.ply: expected an element 'vertex'"},
        BadText{"NoProperty", "ply\nformat ascii 1.0\nelement a 9\nend_header\n", kParse,
                "a 0: its element has no property"},
        BadText{"LongList",
                "ply\nformat ascii 1.0\nelement a 1\nproperty list uint int b\nend_header\n"
                "4000000000 1 2",
                kParse, "s.ply:6: a 0: b: the file ends here"}),
    [](const auto& bad) { return bad.param.name; });

TEST(PlyFile, ReadsRealScans) {
  SEXTANT_REAL_DATA(path, "gicp/source.ply");
  const Expected<PointCloud> cloud = ReadPly(path);
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points.size(), 69792U);
  EXPECT_EQ(cloud->intensity.size(), 69792U);
  EXPECT_TRUE(cloud->ring.empty());
  for (const Eigen::Vector3d& point : cloud->points) ASSERT_LT(point.norm(), 200.0);
}

TEST(PlyFile, WhatIsWrittenReadsBack) {
  PointCloud cloud;
  cloud.points = {{1.5, -2.25, 3.0}, {0.5, 0.0, -8.0}};
  cloud.intensity = {7.0F, 9.5F};
  const std::vector<PlyColor> colors = {{255, 0, 10}, {1, 2, 3}};
  for (const std::string& bytes : {FormatPly(cloud), FormatPly(cloud, colors)}) {
    const Expected<PointCloud> read = ParsePly(bytes, "f.ply");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->points, cloud.points);
    EXPECT_EQ(read->intensity, cloud.intensity);
  }
  cloud.intensity.clear();
  EXPECT_TRUE(ParsePly(FormatPly(cloud), "f.ply")->intensity.empty());
  EXPECT_TRUE(ParsePly(FormatPly({}), "f.ply")->points.empty());
}

}  // namespace
}  // namespace sextant
