// SPDX-License-Identifier: Apache-2.0
// Plain plates, found by their outline.
#include "features/camera/plate_outline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "features/camera/find_boards.h"
#include "features/camera/grey_image.h"
#include "io/cameras/camera_file.h"
#include "simulator/camera/render.h"
#include "simulator/scene/camera_model.h"
#include "support/pictures.h"
#include "support/real_data.h"

namespace sextant::test {
namespace {

using testing::HasSubstr;

constexpr double kPlate_m = 1.016;
const Board kPlate = {.id = 0, .top_right_m = kPlate_m, .right_bottom_m = kPlate_m};

// The corner of the other outline that is nearest to each.
double MeanDistance(const Quad& a, const Quad& b) {
  double sum = 0.0;
  for (const Eigen::Vector2d& corner : a) {
    double nearest = 1e9;
    for (const Eigen::Vector2d& other : b) nearest = std::min(nearest, (corner - other).norm());
    sum += 0.25 * nearest;
  }
  return sum;
}

TEST(PlateOutline, OfARenderedPlateIsThatOfItsPose) {
  for (const double roll_deg : {3.0, 30.0, 45.0}) {
    Scene scene;
    scene.cameras.push_back({.name = "cam", .model = "zed_left"});
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(roll_deg * 0.0174533, Eigen::Vector3d::UnitZ()) *
        Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.5, 1.0, 0.2).normalized()));
    const Rigid3d pose{turn, {0.05, -0.02, 2.2}};
    const Board plate = {.id = 0, .top_right_m = 0.8, .right_bottom_m = 0.6};
    scene.boards.push_back({.board = plate, .world_from_board = pose});
    const Expected<cv::Mat> image =
        RenderImage(scene, 0, {.seed = 1, .blur_sigma_px = 0.7, .noise_sigma_grey = 2.0});
    ASSERT_TRUE(image) << image.error().message;
    const BoardFinder finder = *BoardFinder::Make({plate}, *FindCameraModel("zed_left"));
    const Expected<SeenBoards> seen = finder.Find(*image);
    ASSERT_TRUE(seen);
    const SeenBoard& board = seen->boards[0];
    ASSERT_EQ(board.outlines.size(), 1U) << roll_deg;
    ASSERT_TRUE(board.pose && *board.pose) << roll_deg;
    const Rigid3d& found = (*board.pose)->cam_from_board;
    EXPECT_LT((found.translation - pose.translation).norm(), 0.02) << roll_deg;
    // One of the two orientations that look alike.
    const double half_turn = std::abs(
        (found.rotation * Eigen::Vector3d::UnitZ()).dot(pose.rotation * Eigen::Vector3d::UnitZ()));
    EXPECT_GT(half_turn, std::cos(0.03)) << roll_deg;
    const double along = std::abs(
        (found.rotation * Eigen::Vector3d::UnitX()).dot(pose.rotation * Eigen::Vector3d::UnitX()));
    EXPECT_GT(along, std::cos(0.03)) << roll_deg;
  }
}

// Ranges of the plate's returns in the scan of the same moment: the sensors are 0.2 m apart.
struct PlatePhoto {
  const char* file;
  double range_m;
};

TEST(PlateOutline, OfAWhitePlateInRealPhotosIsAsFarAsInTheScans) {
  SEXTANT_REAL_DATA(folder, "");
  const Camera camera = *ReadCamera(folder / "ouster64/basler.yaml");
  const BoardFinder finder = *BoardFinder::Make({kPlate}, camera);
  for (const PlatePhoto& photo : {PlatePhoto{"frame0.png", 2.47}, PlatePhoto{"frame4.png", 2.96},
                                  PlatePhoto{"frame9.png", 3.20}, PlatePhoto{"frame20.png", 3.15},
                                  PlatePhoto{"frame31.png", 3.27}}) {
    const Expected<SeenBoards> seen =
        finder.Find(ReadPicture((folder / "field/ouster64_garage" / photo.file).string()));
    ASSERT_TRUE(seen) << seen.error().message;
    const SeenBoard& board = seen->boards[0];
    EXPECT_LE(board.outlines.size(), 1U) << photo.file;
    if (!board.pose || !*board.pose) continue;
    EXPECT_NEAR((*board.pose)->cam_from_board.translation.norm(), photo.range_m, 0.4) << photo.file;
  }
}

TEST(PlateOutline, IsFoundOnlyWithACamera) {
  const Expected<BoardFinder> finder = BoardFinder::Make({kPlate}, std::nullopt);
  ASSERT_FALSE(finder);
  EXPECT_THAT(finder.error().message, HasSubstr("with a camera's intrinsics"));
  Board other = kPlate;
  other.id = 1;
  const Expected<BoardFinder> two =
      BoardFinder::Make({kPlate, other}, *FindCameraModel("zed_left"));
  ASSERT_FALSE(two);
  EXPECT_THAT(two.error().message, HasSubstr("does not tell two plain plates apart"));
}

}  // namespace
}  // namespace sextant::test
