// SPDX-License-Identifier: Apache-2.0
// Invalid scenes are rejected with a message that names the object.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "simulator/lidar/scan.h"
#include "support/lidar_scenes.h"

namespace sextant {
namespace {

using testing::HasSubstr;

Error ErrorOf(const Scene& scene) {
  const Expected<SimulatedScan> scan = SimulateScan(scene, test::Model("vlp16"));
  EXPECT_FALSE(scan);
  return scan ? Error{} : scan.error();
}

template <class Change>
Error AfterChange(Change change) {
  Scene scene = test::FullRoom();
  change(scene);
  return ErrorOf(scene);
}

TEST(BadScan, SizesMustBePositive) {
  const Error board = AfterChange([](Scene& s) { s.boards[1].board.top_right_m = -0.5; });
  EXPECT_EQ(board.code, ErrorCode::kInvalidInput);
  EXPECT_THAT(board.message, HasSubstr("board 1"));
  EXPECT_THAT(AfterChange([](Scene& s) { s.walls[0].height_m = 0.0; }).message,
              HasSubstr("wall 'front'"));
  EXPECT_THAT(AfterChange([](Scene& s) { s.boxes[0].size_m.y() = -1.0; }).message,
              HasSubstr("box 'crate'"));
  EXPECT_THAT(AfterChange([](Scene& s) { s.cylinders[0].radius_m = 0.0; }).message,
              HasSubstr("cylinder 'person'"));
  EXPECT_THAT(AfterChange([](Scene& s) { s.boards[0].board.thickness_m = -0.01; }).message,
              HasSubstr("thickness"));
}

TEST(BadScan, NumbersMustBeFinite) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(AfterChange([](Scene& s) { s.lidar.world_from_lidar.translation.x() = kNan; }).code,
            ErrorCode::kNonFinite);
  EXPECT_EQ(AfterChange([](Scene& s) { s.boxes[0].world_from_box.translation.x() = kNan; }).code,
            ErrorCode::kNonFinite);
  EXPECT_EQ(AfterChange([](Scene& s) { s.boards[0].board.top_right_m = kNan; }).code,
            ErrorCode::kNonFinite);
}

TEST(BadScan, TagsMustExist) {
  const Error error = AfterChange([](Scene& s) { s.boards[1].board.tags[0].id = 5000; });
  EXPECT_EQ(error.code, ErrorCode::kInvalidInput);
  EXPECT_THAT(error.message, HasSubstr("5000"));
}

TEST(BadScan, TheLidarMustBeOutsideOfObjects) {
  EXPECT_THAT(AfterChange([](Scene& s) {
                s.boxes[0].world_from_box.translation = s.lidar.world_from_lidar.translation;
              }).message,
              HasSubstr("inside box 'crate'"));
  EXPECT_THAT(AfterChange([](Scene& s) { s.cylinders[0].base_in_world.setZero(); }).message,
              HasSubstr("inside cylinder 'person'"));
}

TEST(BadScan, RejectsAMillionBoards) {
  EXPECT_THAT(AfterChange([](Scene& s) { s.boards.resize(1000000); }).message,
              HasSubstr("10000 at most"));
}

TEST(BadScan, ASwingNeedsAPeriod) {
  EXPECT_THAT(AfterChange([](Scene& s) { s.boards[0].swing = Swing{.period_s = 0.0}; }).message,
              HasSubstr("period"));
}

}  // namespace
}  // namespace sextant
