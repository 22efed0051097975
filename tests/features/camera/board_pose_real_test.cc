// SPDX-License-Identifier: Apache-2.0
// Poses of real boards whose publishers give them.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "features/camera/find_boards.h"
#include "geometry/board_check.h"
#include "io/acfr_poses.h"
#include "io/board_file.h"
#include "io/camera_file.h"
#include "io/marker_files.h"
#include "io/points_file.h"
#include "support/real_data.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using nlohmann::json;

// The package found the pose of each marker from its four pixels, and the board's corners from
// that.
TEST(DhallSession, PixelsGiveTheStoredPosesAndBoardCorners) {
  SEXTANT_REAL_DATA(folder, "dhall");
  const auto session = folder / "session_2017-05-03";
  const auto markers = ReadDetectedMarkers(session / "transform.txt");
  const auto coordinates = ReadMarkerCoordinates(session / "marker_coordinates.txt");
  const auto camera = ReadCamera(folder / "zed_left_uurmi.ini");
  const auto pairs = ReadPoints(session / "points.txt");
  ASSERT_TRUE(markers && coordinates && camera && pairs);
  const auto boards = BoardsWithTags(*coordinates);
  ASSERT_TRUE(boards) << boards.error().message;
  ASSERT_EQ(markers->size(), 2U);
  ASSERT_EQ(pairs->pairs_3d3d.size(), 8U);
  for (std::size_t b = 0; b < 2; ++b) {
    const BoardTag& tag = (*boards)[b].tags[0];
    const DetectedMarker& marker = (*markers)[b];
    ASSERT_EQ(tag.id, marker.id);
    const auto corners = TagCorners(tag);
    const BoardPoints points{.in_board_m = {corners.begin(), corners.end()},
                             .pixels = {marker.corners_px.begin(), marker.corners_px.end()},
                             .covariance_px2 = Eigen::MatrixXd::Identity(8, 8)};
    const Expected<BoardPose> pose = EstimateBoardPose(*camera, {&points, 1});
    ASSERT_TRUE(pose) << pose.error().message;
    const Eigen::Vector3d marker_center =
        pose->cam_from_board *
        Eigen::Vector3d(tag.center_in_board_m.x(), tag.center_in_board_m.y(), 0.0);
    EXPECT_LT((marker_center - marker.translation_m).norm(), 1e-5 * 3.0) << b;
    const PointsInCam in_cam = ToCamera(*pose, BoardCorners((*boards)[b]));
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_LT((in_cam.points[k] - pairs->pairs_3d3d[4 * b + k].point_in_cam).norm(), 3e-5)
          << b << k;
    }
  }
}

TEST(Fiducials, PoseOfTheFirstPhoto) {
  SEXTANT_REAL_DATA(folder, "fiducials");
  const json gold = json::parse(test::ReadText(folder / "expected.json"));
  Camera camera{.model = CameraModel::kBrownConrady,
                .fx_px = gold.at("K").at(0),
                .fy_px = gold.at("K").at(4),
                .cx_px = gold.at("K").at(2),
                .cy_px = gold.at("K").at(5)};
  for (std::size_t i = 0; i < 5; ++i) camera.distortion[i] = gold.at("D").at(i);
  Board board{.id = 0, .top_right_m = 0.2, .right_bottom_m = 0.2};
  board.tags = {{.family = "aruco_5x5_1000", .id = 1, .edge_m = gold.at("marker_m")}};
  const BoardFinder finder = *BoardFinder::Make({board}, camera);
  const auto seen = finder.Find(cv::imread((folder / "tag_01_d7_14cm.png").string()));
  ASSERT_TRUE(seen) << seen.error().message;
  const SeenBoard& found = seen->boards[0];
  ASSERT_TRUE(found.pose && *found.pose);
  ASSERT_TRUE(found.tags[0].refined) << found.tags[0].refined.error().message;
  const Eigen::Vector3d published(0.0095, -0.1240, 0.6918);
  EXPECT_LT(((*found.pose)->cam_from_board.translation - published).norm(), 0.002);
  EXPECT_LT((*found.pose)->rms_px, 0.2);
  const json& corners = gold.at("tag_01_d7_14cm.png").at("1");
  double largest = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d theirs(corners.at(k).at(0).get<double>(),
                                 corners.at(k).at(1).get<double>());
    largest = std::max(largest, (found.tags[0].refined->corners_px[k] - theirs).norm());
  }
  EXPECT_LT(largest, 0.5);
  RecordProperty("refined_from_gold_px", std::to_string(largest));
}

// The publishers' own detections, through a fisheye. Their row of pose 1 is another placement's.
TEST(AcfrImages, BoardCentreAsPublished) {
  SEXTANT_REAL_DATA(folder, "acfr_vlp16");
  const auto camera = ReadCamera(folder / "camera_info.yaml");
  const auto poses = ReadAcfrPoses(folder / "poses.csv");
  ASSERT_TRUE(camera && poses);
  Board board{.id = 0, .top_right_m = 0.85, .right_bottom_m = 0.61};
  board.checker = BoardChecker{.inner_columns = 7, .inner_rows = 5, .square_m = 0.095};
  const BoardFinder finder = *BoardFinder::Make({board}, *camera);
  for (const int id : {2, 5, 26}) {
    const auto image = folder / "images" / ("pose" + std::to_string(id) + ".png");
    const auto seen = finder.Find(cv::imread(image.string()));
    ASSERT_TRUE(seen) << seen.error().message;
    ASSERT_TRUE(seen->boards[0].pose && *seen->boards[0].pose) << image;
    const BoardPose& pose = **seen->boards[0].pose;
    EXPECT_LT(pose.rms_px, 0.4) << image;
    const auto row = std::ranges::find(*poses, id, &AcfrPose::id);
    ASSERT_NE(row, poses->end());
    EXPECT_LT((pose.cam_from_board.translation - row->in_cam.centre_m).norm(), 0.003) << image;
  }
}

}  // namespace
}  // namespace sextant
