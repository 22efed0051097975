// SPDX-License-Identifier: Apache-2.0
// Tables of pairs as other programs write them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "io/problems/read_problem.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(CsvDialects, OfOtherProgramsAreTheSamePairs) {
  SEXTANT_REAL_DATA(spaces, "../cases/csv_dialects/spaces.csv");
  const CalibrationProblem right = ReadProblem(spaces).value().problem;
  ASSERT_EQ(right.pairs_2d3d.size(), 12U);
  for (const char* name : {"blanks.txt", "extra.csv", "idname.csv", "lidar_names.csv",
                           "noheader.csv", "px.csv", "semicolon.csv", "tabs.csv", "upper.csv"}) {
    const Expected<DetectedProblem> read = ReadProblem(spaces.parent_path() / name);
    ASSERT_TRUE(read) << name << ": " << read.error().message;
    ASSERT_EQ(read->problem.pairs_2d3d.size(), 12U) << name;
    for (std::size_t i = 0; i < 12; ++i) {
      EXPECT_EQ(read->problem.pairs_2d3d[i].pixel, right.pairs_2d3d[i].pixel) << name;
      EXPECT_EQ(read->problem.pairs_2d3d[i].point_in_lidar, right.pairs_2d3d[i].point_in_lidar);
      EXPECT_EQ(read->problem.pairs_2d3d[i].id, right.pairs_2d3d[i].id) << name;
    }
  }
}

TEST(CsvDialects, WhatIsAssumedIsNoted) {
  SEXTANT_REAL_DATA(spaces, "../cases/csv_dialects/spaces.csv");
  const auto notes = [&](const char* name) {
    return ReadProblem(spaces.parent_path() / name).value().notes;
  };
  EXPECT_THAT(notes("spaces.csv"), IsEmpty());
  EXPECT_THAT(notes("noheader.csv"), Contains(HasSubstr("taken as u,v,x,y,z")));
  EXPECT_THAT(notes("extra.csv"), Contains(HasSubstr("'name' is not used")));
}

TEST(CsvDialects, WhatCannotBeReadIsNamed) {
  SEXTANT_REAL_DATA(spaces, "../cases/csv_dialects/spaces.csv");
  const auto error = [&](const char* name) {
    return ReadProblem(spaces.parent_path() / name).error().message;
  };
  EXPECT_THAT(error("nan.csv"), HasSubstr("nan.csv:3: field 1 (u): expected a finite number"));
  EXPECT_THAT(error("decimalcomma.csv"), HasSubstr("decimal commas"));
}

Expected<CalibrationProblem> Parse(const char* text) {
  return ParseProblem(text, "p.csv").map([](const DetectedProblem& read) { return read.problem; });
}

TEST(CsvDialects, ColumnsOfEveryForm) {
  for (const char* text :
       {"u;v;x;y;z\n1,5;2;3;4;5\n", "\"U [px]\",\"V [px]\",\"X (m)\",Y_,Z\n1.5,2,3,4,5\n",
        "x,y,X,Y,Z\n1.5,2,3,4,5\n", "x_lidar,y_lidar,z_lidar,pixel_x,pixel_y\n3,4,5,1.5,2\n",
        "image_x\timage_y\tworld_x\tworld_y\tworld_z\n1.5\t2\t3\t4\t5\n"}) {
    const Expected<CalibrationProblem> read = Parse(text);
    ASSERT_TRUE(read) << text << read.error().message;
    ASSERT_EQ(read->pairs_2d3d.size(), 1U) << text;
    EXPECT_EQ(read->pairs_2d3d[0].pixel, Eigen::Vector2d(1.5, 2)) << text;
    EXPECT_EQ(read->pairs_2d3d[0].point_in_lidar, Eigen::Vector3d(3, 4, 5)) << text;
  }
  const Expected<CalibrationProblem> last = Parse("0.5 1 2 640 360\n");
  ASSERT_TRUE(last) << last.error().message;
  EXPECT_EQ(last->pairs_2d3d[0].pixel, Eigen::Vector2d(640, 360));
  for (const char* text :
       {"cam_x,cam_y,cam_z,velo_x,velo_y,velo_z\n1,2,3,4,5,6\n", "1,2,3,4,5,6\n"}) {
    const Expected<CalibrationProblem> points = Parse(text);
    ASSERT_TRUE(points) << points.error().message;
    EXPECT_EQ(points->pairs_3d3d[0].point_in_lidar, Eigen::Vector3d(4, 5, 6));
  }
}

}  // namespace
}  // namespace sextant
