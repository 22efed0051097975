// SPDX-License-Identifier: Apache-2.0
// The forms in which people have scans: tables without a header, arrays of NumPy, five floats a
// point, the fields of drivers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <set>

#include "io/clouds/cloud_file.h"
#include "io/clouds/npy_cloud.h"
#include "io/clouds/pcd_file.h"
#include "support/bad_text.h"
#include "support/real_data.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::string BytesOf(const std::vector<float>& values) {
  std::string bytes;
  for (const float value : values) {
    const auto raw = std::bit_cast<std::array<char, 4>>(value);
    bytes.append(raw.data(), raw.size());
  }
  return bytes;
}

// `descr` as the header has it: a type in quotes, or a list of fields.
std::string NpyText(const std::string& descr, const std::string& shape, const std::string& numbers,
                    const std::string& order = "False") {
  const std::string header =
      "{'descr': " + descr + ", 'fortran_order': " + order + ", 'shape': " + shape + ", }\n";
  return std::string(kNpyMagic) + '\1' + '\0' + static_cast<char>(header.size()) + '\0' + header +
         numbers;
}

std::string Npy(const std::string& descr, const std::string& order, const std::string& shape,
                const std::string& numbers) {
  return NpyText("'" + descr + "'", shape, numbers, order);
}

TEST(CloudForms, TablesWithoutAHeaderAreReadByTheNumberOfTheirColumns) {
  for (const char* text : {"1 2 3 7 0\n4 5 6 8 1\n", "1;2;3;7;0\n4;5;6;8;1\n",
                           "2\n1\t2\t3\t7\t0\n4\t5\t6\t8\t1\n", "# a\n1, 2, 3, 7, 0\n4,5,6,8,1"}) {
    for (const char* name : {"s.txt", "s.pts", "s.anything"}) {
      const Expected<PointCloud> cloud = ParseCloud(text, name);
      ASSERT_TRUE(cloud) << cloud.error().message;
      EXPECT_THAT(cloud->points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
      EXPECT_THAT(cloud->intensity, ElementsAre(7, 8));
      EXPECT_THAT(cloud->ring, SizeIs(2));
    }
  }
  EXPECT_THAT(ParseCloud("1 2 3 7 0.5\n", "s.xyz")->ring, IsEmpty());
  EXPECT_THAT(ParseCloud("1 2 3 90 80 70\n", "s.xyz")->intensity, IsEmpty());
}

TEST(CloudForms, NamesMayBeSeparatedByBlanksOrSemicolons) {
  for (const char* text :
       {"z;x;y\n3;1;2\n", "z x y\n3 1 2\n", "//Z X Y\n3 1 2\n", "z [m],x(m),y [m]\n3,1,2\n",
        "point_x,point_y,point_z\n1,2,3\n", "1,2,3,\n", "x,y,z,\n1,2,3,\n"}) {
    const Expected<PointCloud> cloud = ParseCloud(text, "s.asc");
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_THAT(cloud->points, ElementsAre(Eigen::Vector3d(1, 2, 3)));
  }
}

TEST(CloudForms, ArraysOfNumPyAreReadInBothOrders) {
  const std::string rows = Npy("<f4", "False", "(2, 3)", BytesOf({1, 2, 3, 4, 5, 6}));
  const std::string columns = Npy("<f4", "True", "(2, 3)", BytesOf({1, 4, 2, 5, 3, 6}));
  for (const std::string& bytes : {rows, columns}) {
    const Expected<PointCloud> cloud = ParseCloud(bytes, "s");
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_THAT(cloud->points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
  }
}

TEST(CloudForms, ArraysOfNumPyMayBeOrganisedOrHoldOneCoordinateAfterTheOther) {
  const std::string rows = Npy("<f4", "False", "(1, 2, 3)", BytesOf({1, 2, 3, 4, 5, 6}));
  const Expected<PointCloud> organised = ParseCloud(rows, "s.npy");
  ASSERT_TRUE(organised) << organised.error().message;
  EXPECT_THAT(organised->points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(4, 5, 6)));
  std::vector<float> coordinates;
  for (int i = 0; i < 3 * 17; ++i) coordinates.push_back(static_cast<float>(i));
  const Expected<PointCloud> columns =
      ParseCloud(Npy("<f4", "False", "(3, 17)", BytesOf(coordinates)), "s.npy");
  ASSERT_TRUE(columns) << columns.error().message;
  ASSERT_THAT(columns->points, SizeIs(17));
  EXPECT_EQ(columns->points[16], Eigen::Vector3d(16, 33, 50));
}

// As ros_numpy and numpy.fromfile of a driver's points leave them.
TEST(CloudForms, FieldsOfNumPyAreReadByTheirNames) {
  const std::string point = BytesOf({1, 2, 3}) + std::string("\7\0\0\0", 4) + BytesOf({9, 9});
  const Expected<PointCloud> cloud =
      ParseCloud(NpyText("[('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('ring', '<u2'), ('', '|V2'), "
                         "('normal', '<f4', (2,))]",
                         "(2,)", point + point),
                 "s.npy");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_THAT(cloud->points, ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(1, 2, 3)));
  EXPECT_THAT(cloud->ring, ElementsAre(7, 7));
}

TEST(CloudForms, OtherArraysAreRefused) {
  const std::string numbers = BytesOf({1, 2, 3, 4, 5, 6});
  for (const auto& [bytes, message] : std::vector<std::pair<std::string, const char*>>{
           {Npy("<i4", "False", "(2, 3)", numbers), "expected numbers of type float32 or float64"},
           {Npy("<f4", "False", "(3, 2)", numbers),
            "expected an array of points x 3 to 16 columns"},
           {Npy("<f4", "False", "(6,)", numbers), "got the shape '(6,)"},
           {Npy("<f4", "False", "(4611686018427387904, 4)", numbers), "the file has 24 bytes"},
           {Npy("<f4", "False", "(3, 3)", numbers), "states the shape '(3, 3)"},
           {NpyText("[('x', '<f4'), ('y', '<f4'), ('w', '<f4')]", "(2,)", numbers), "z is missing"},
           {NpyText("[('x', '<f4'), ('y', '<f4'), ('z', '<f4')]", "(3,)", numbers), "12 bytes a"},
           // Lengths whose product would not fit in 64 bits.
           {NpyText("[('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('w', '<f4', (4096, 4096, 4096)), "
                    "('v', '<f4', (4096, 4096, 4096, 4096))]",
                    "(2,)", numbers),
            "fields with"},
           {NpyText("[('x', '|O'), ('y', '<f4'), ('z', '<f4')]", "(2,)", numbers), "fields with"},
           {std::string(kNpyMagic) + "\1", "expected the header of a .npy file"}}) {
    const Expected<PointCloud> cloud = ParseCloud(bytes, "s.npy");
    ASSERT_FALSE(cloud) << message;
    EXPECT_THAT(cloud.error().message, HasSubstr(message));
  }
}

TEST(CloudForms, FiveFloatsAreRecognisedByTheFifth) {
  std::vector<float> five;
  std::vector<float> four;
  for (int i = 0; i < 20; ++i) {
    const auto x = static_cast<float>(i);
    five.insert(five.end(), {x + 0.5F, 2, 3.25F, 7, x});
    four.insert(four.end(), {x + 0.5F, 2, 3.25F, 7});
  }
  const Expected<PointCloud> rings = ParseCloud(BytesOf(five), "s.pcd.bin");
  ASSERT_TRUE(rings) << rings.error().message;
  EXPECT_THAT(rings->points, SizeIs(20));
  EXPECT_THAT(rings->ring, SizeIs(20));
  const Expected<PointCloud> none = ParseCloud(BytesOf(four), "s.bin");
  ASSERT_TRUE(none) << none.error().message;
  EXPECT_THAT(none->points, SizeIs(20));
  EXPECT_THAT(none->ring, IsEmpty());
}

// Three floats a point, or five whose last is a time: the size alone would fit KITTI's four.
TEST(CloudForms, OtherCountsOfFloatsAreRecognisedByTheirColumns) {
  for (const std::size_t numbers : {3U, 4U, 5U, 6U}) {
    std::vector<float> values;
    for (int i = 0; i < 480; ++i) {
      const float turn = 0.1F * static_cast<float>(i);
      const std::array<float, 6> point = {8.0F * std::cos(turn),
                                          8.0F * std::sin(turn),
                                          0.03F * static_cast<float>(i % 40) - 1.7F,
                                          0.31F,
                                          0.0002F * static_cast<float>(i),
                                          0.01F};
      values.insert(values.end(), point.begin(),
                    point.begin() + static_cast<std::ptrdiff_t>(numbers));
    }
    const Expected<PointCloud> cloud = ParseCloud(BytesOf(values), "s.bin");
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_THAT(cloud->points, SizeIs(480)) << numbers;
    EXPECT_NEAR(cloud->points[479].z(), 0.03 * 39 - 1.7, 1e-5) << numbers;
  }
}

TEST(CloudForms, DoublesAndIntegersInABinaryFileAreNoticed) {
  std::string doubles;
  std::string integers;
  for (int i = 0; i < 400; ++i) {
    const auto as_double = std::bit_cast<std::array<char, 8>>(1.0 / 3.0 + i);
    doubles.append(as_double.data(), as_double.size());
    const auto as_integer = std::bit_cast<std::array<char, 4>>(1234 + i);
    integers.append(as_integer.data(), as_integer.size());
  }
  for (const std::string& bytes : {doubles, integers}) {
    const Expected<PointCloud> cloud = ParseCloud(bytes, "s.bin");
    ASSERT_FALSE(cloud);
    EXPECT_THAT(cloud.error().message, HasSubstr("expected float32"));
  }
}

TEST(CloudForms, DecimalCommasBetweenSemicolonsOrTabs) {
  for (const char* text : {"x;y;z\n1,5;-2,25;3\n", "1,5\t-2,25\t3,0\n"}) {
    const Expected<PointCloud> cloud = ParseCloud(text, "s.csv");
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_THAT(cloud->points, ElementsAre(Eigen::Vector3d(1.5, -2.25, 3)));
  }
}

// A LAS file of version 1.`minor` with two points of a format whose record has `bytes`.
std::string Las(int minor, int format, int bytes, int points) {
  const auto put = [](std::string& text, std::size_t at, const auto& value) {
    const auto raw = std::bit_cast<std::array<char, sizeof(value)>>(value);
    text.replace(at, raw.size(), raw.data(), raw.size());
  };
  const std::size_t head = minor >= 4 ? 375 : 227;
  std::string las(head, '\0');
  las.replace(0, 4, "LASF");
  las[25] = static_cast<char>(minor);
  put(las, 96, static_cast<std::uint32_t>(head));
  las[104] = static_cast<char>(format);
  put(las, 105, static_cast<std::uint16_t>(bytes));
  if (minor >= 4) {
    put(las, 247, static_cast<std::uint64_t>(points));
  } else {
    put(las, 107, static_cast<std::uint32_t>(points));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) put(las, 131 + 8 * axis, 0.001);
  put(las, 155, 10.0);
  for (int i = 0; i < 2; ++i) {
    std::string record(static_cast<std::size_t>(bytes), '\0');
    put(record, 0, std::int32_t{1500 + i});
    put(record, 4, std::int32_t{-2000});
    put(record, 8, std::int32_t{250});
    put(record, 12, std::uint16_t{7});
    las += record;
  }
  return las;
}

TEST(CloudForms, UncompressedLasIsRead) {
  for (const auto& [minor, format, bytes] :
       std::vector<std::array<int, 3>>{{2, 0, 20}, {2, 3, 34}, {4, 6, 30}, {2, 1, 32}}) {
    const Expected<PointCloud> cloud = ParseCloud(Las(minor, format, bytes, 2), "s.las");
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_THAT(cloud->points, SizeIs(2));
    EXPECT_NEAR((cloud->points[1] - Eigen::Vector3d(11.501, -2.0, 0.25)).norm(), 0.0, 1e-12);
    EXPECT_THAT(cloud->intensity, ElementsAre(7, 7));
  }
}

TEST(CloudForms, OtherLasIsRefused) {
  std::string compressed = Las(2, 0, 20, 2);
  compressed[104] = static_cast<char>(128);
  for (const auto& [bytes, message] : std::vector<std::pair<std::string, const char*>>{
           {compressed, "pdal translate"},
           {Las(2, 0, 20, 3), "the header states 3 points of 20 bytes"},
           {Las(2, 3, 20, 2), "points of format 3 have 34 bytes"},
           {Las(2, 11, 67, 2), "expected a point format from 0 to 10"},
           {Las(2, 0, 20, 2).substr(0, 200), "ends within the header"}}) {
    const Expected<PointCloud> cloud = ParseCloud(bytes, "s.las");
    ASSERT_FALSE(cloud) << message;
    EXPECT_THAT(cloud.error().message, HasSubstr(message));
  }
}

TEST(CloudForms, FieldsThatStateNoCountHaveOneValue) {
  const Expected<PointCloud> cloud = ParseCloud(
      "VERSION .7\nFIELDS x y z _ intensity\nSIZE 4 4 4 1 4\nTYPE F F F U F\nCOUNT 0 0 0 0 0\n"
      "WIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA binary\n" +
          BytesOf({1, 2, 3, 7}),
      "s.pcd");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_THAT(cloud->points, ElementsAre(Eigen::Vector3d(1, 2, 3)));
  EXPECT_THAT(cloud->intensity, ElementsAre(7));
}

TEST(CloudForms, AGitLfsPointerIsNamed) {
  const std::filesystem::path path = test::TestFolder() / "scan.pcd";
  test::WriteText(path, "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 7\n");
  const Expected<PointCloud> cloud = ReadCloud(path);
  ASSERT_FALSE(cloud);
  EXPECT_EQ(cloud.error().code, ErrorCode::kParse);
  EXPECT_THAT(cloud.error().message, HasSubstr("Git LFS pointer"));
}

// One scan of a VLP-16 in all of them.
TEST(CloudForms, AllFormsOfARealScanGiveTheSamePoints) {
  SEXTANT_REAL_DATA(folder, "field/clouds");
  const PointCloud whole = ReadCloud(folder / "xyzi.npy").value();
  ASSERT_THAT(whole.points, SizeIs(19026));
  struct Form {
    const char* file;
    std::size_t rings;
    double tolerance_m;  // For coordinates as text.
    std::size_t points = 19026;
  };
  for (const Form& form : std::vector<Form>{{"livox_driver2.pcd", 0, 0.0},
                                            {"xyzi5.bin", 16, 0.0},
                                            {"nuscenes5_n_mod4.bin", 16, 0.0, 19024},
                                            {"semicolon.csv", 0, 1e-3},
                                            {"xyz.xyz", 0, 1e-3},
                                            {"xyzi.txt", 0, 1e-3}}) {
    const Expected<PointCloud> cloud = ReadCloud(folder / form.file);
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_THAT(cloud->points, SizeIs(form.points)) << form.file;
    for (std::size_t i = 0; i < form.points; ++i) {
      ASSERT_LE((cloud->points[i] - whole.points[i]).norm(), form.tolerance_m) << form.file;
    }
    const std::set<std::uint16_t> rings(cloud->ring.begin(), cloud->ring.end());
    EXPECT_THAT(rings, SizeIs(form.rings)) << form.file;
  }
}

TEST(CloudForms, TimesOfLivoxDriverAreSecondsOfTheScan) {
  SEXTANT_REAL_DATA(path, "field/clouds/livox_driver2.pcd");
  const PointCloud cloud = ReadCloud(path).value();
  ASSERT_THAT(cloud.time_s, SizeIs(19026));
  EXPECT_EQ(cloud.time_s.front(), 0.0);
  EXPECT_NEAR(cloud.time_s.back(), 0.1, 0.01);
}

TEST(CloudForms, PaddingOfAVelodyneIsSkipped) {
  SEXTANT_REAL_DATA(path, "field/clouds/velodyne_padded.pcd");
  const PointCloud cloud = ReadCloud(path).value();
  ASSERT_THAT(cloud.points, SizeIs(24025));
  const std::set<std::uint16_t> rings(cloud.ring.begin(), cloud.ring.end());
  EXPECT_THAT(rings, SizeIs(16));
}

TEST(CloudForms, MillimetresAreNoticed) {
  SEXTANT_REAL_DATA(path, "field/clouds/mm.pcd");
  const Expected<PointCloud> cloud = ReadCloud(path);
  ASSERT_FALSE(cloud);
  EXPECT_EQ(cloud.error().code, ErrorCode::kInvalidInput);
  EXPECT_THAT(cloud.error().message, HasSubstr("in metres"));
}

}  // namespace
}  // namespace sextant
