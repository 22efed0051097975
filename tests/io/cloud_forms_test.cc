// SPDX-License-Identifier: Apache-2.0
// The forms in which people have scans: tables without a header, arrays of NumPy, five floats a
// point, the fields of drivers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
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

std::string Npy(std::string_view descr, std::string_view order, std::string_view shape,
                const std::string& numbers) {
  const std::string header = "{'descr': '" + std::string(descr) +
                             "', 'fortran_order': " + std::string(order) +
                             ", 'shape': " + std::string(shape) + ", }\n";
  return std::string(kNpyMagic) + '\1' + '\0' + static_cast<char>(header.size()) + '\0' + header +
         numbers;
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
  for (const char* text : {"z;x;y\n3;1;2\n", "z x y\n3 1 2\n", "//Z X Y\n3 1 2\n"}) {
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

TEST(CloudForms, OtherArraysAreRefused) {
  const std::string numbers = BytesOf({1, 2, 3, 4, 5, 6});
  for (const auto& [bytes, message] : std::vector<std::pair<std::string, const char*>>{
           {Npy("<i4", "False", "(2, 3)", numbers), "expected numbers of type float32 or float64"},
           {Npy("<f4", "False", "(3, 2)", numbers), "expected an array of points x 3 to 6 columns"},
           {Npy("<f4", "False", "(6,)", numbers), "got the shape '(6,)"},
           {Npy("<f4", "False", "(4611686018427387904, 4)", numbers), "has room for 6"},
           {Npy("<f4", "False", "(3, 3)", numbers), "states 3 x 3 numbers"},
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
    double tolerance_m;  // Of coordinates as text.
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
