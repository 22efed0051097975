// SPDX-License-Identifier: Apache-2.0
// Sessions recorded by others, from files to the pose: other sensors, boards in hands, in the open,
// in any orientation, and described with either edge first.
#include <fmt/core.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/units.h"
#include "calibrate/acfr_session.h"
#include "calibrate/calibrate.h"
#include "io/boards/board_file.h"
#include "io/cameras/camera_file.h"
#include "support/real_data.h"

namespace sextant::test {
namespace {

using testing::HasSubstr;

Session SessionIn(const std::filesystem::path& images, const std::filesystem::path& clouds) {
  const Expected<Session> session = SessionOfFiles(std::vector<std::string>{images.string()},
                                                   std::vector<std::string>{clouds.string()});
  EXPECT_TRUE(session) << session.error().message;
  return session.value_or(Session{});
}

// The same board described with its edges exchanged: the print turns with them.
Board Exchanged(const Board& board) {
  Board other = board;
  std::swap(other.top_right_m, other.right_bottom_m);
  if (other.checker) std::swap(other.checker->inner_columns, other.checker->inner_rows);
  return other;
}

CalibrateOptions OptionsFor(const Board& board, const Camera& camera) {
  CalibrateOptions options;
  options.boards = {board};
  options.camera = camera;
  options.bootstrap_samples = 0;
  return options;
}

std::size_t KeptIn(const Calibration& calibration) {
  return static_cast<std::size_t>(
      std::ranges::count(calibration.assembly.rows, BoardStatus::kKept, &BoardRow::fate));
}

std::string RowsOf(const Calibration& calibration) {
  std::string text;
  for (const BoardRow& row : calibration.assembly.rows) {
    text += fmt::format("\n{}: {} {}", calibration.observed.views[row.view].name,
                        ToString(row.fate), row.why);
  }
  return text;
}

struct Limits {
  double translation_m = 0.0;
  double rotation_deg = 0.0;
};

void ExpectPose(const Calibration& calibration, const Rigid3d& expected, const Limits& limits) {
  ASSERT_TRUE(calibration.result) << calibration.result.error().message;
  const PoseDistance off = DistanceBetween(calibration.result->cam_from_lidar, expected);
  EXPECT_LT(off.translation_m, limits.translation_m) << RowsOf(calibration);
  EXPECT_LT(off.rotation_rad * kDegPerRad, limits.rotation_deg) << RowsOf(calibration);
}

Rigid3d Pose(const Eigen::Matrix3d& rows, const Eigen::Vector3d& translation) {
  return {Eigen::Quaterniond(rows).normalized(), translation};
}

// A single view gives the session's pose or none, within its own accuracy.
void ExpectEachViewAgrees(const ObservedSession& observed, CalibrateOptions options,
                          const Rigid3d& cam_from_lidar) {
  options.match.initial = cam_from_lidar;
  for (std::size_t i = 0; i < observed.views.size(); ++i) {
    ObservedSession one = observed;
    one.session.files.pairs = {observed.session.files.pairs[i]};
    one.views = {observed.views[i]};
    const Calibration calibration = CalibrateObserved(std::move(one), options);
    if (!calibration.result) continue;
    const PoseDistance off = DistanceBetween(calibration.result->cam_from_lidar, cam_from_lidar);
    EXPECT_LT(off.translation_m, 0.3) << observed.views[i].name;
    EXPECT_LT(off.rotation_rad * kDegPerRad, 6.0) << observed.views[i].name;
  }
}

TEST(FieldSessions, AcfrInBothDescriptionsOfTheBoardAndViewsOneByOne) {
  SEXTANT_REAL_DATA(folder, "acfr_vlp16");
  std::vector<Rigid3d> poses;
  for (const Expected<ObservedSession>& observed :
       {AcfrSession(folder), ObserveAcfr(folder, Exchanged(AcfrBoard()))}) {
    ASSERT_TRUE(observed) << observed.error().message;
    const CalibrateOptions options = OptionsFor(observed->boards[0], observed->camera);
    const Calibration calibration = CalibrateObserved(*observed, options);
    EXPECT_EQ(KeptIn(calibration), 20U) << RowsOf(calibration);
    ASSERT_TRUE(calibration.result) << calibration.result.error().message;
    poses.push_back(calibration.result->cam_from_lidar);
    if (poses.size() == 2) ExpectEachViewAgrees(*observed, options, poses.back());
  }
  const PoseDistance off = DistanceBetween(poses[0], poses[1]);
  EXPECT_LT(off.translation_m, 0.001);
  EXPECT_LT(off.rotation_rad * kDegPerRad, 0.02);
}

TEST(FieldSessions, RoadWithAPlateOnTheGroundAndInHands) {
  SEXTANT_REAL_DATA(folder, "field/vlp16_road");
  const Camera camera = *ReadCamera(folder / "camera.yaml");
  const Board board = (*ReadBoards(folder / "board.yaml"))[0];
  const Session session = SessionIn(folder / "*.jpg", folder / "*.pcd");
  for (const Board& described : {board, Exchanged(board)}) {
    const Expected<Calibration> calibration = Calibrate(session, OptionsFor(described, camera));
    ASSERT_TRUE(calibration) << calibration.error().message;
    EXPECT_EQ(KeptIn(*calibration), 10U) << RowsOf(*calibration);
    ASSERT_TRUE(calibration->result) << calibration->result.error().message;
    const Eigen::Vector3d t = calibration->result->cam_from_lidar.translation;
    // The data hold it to 30 to 50 mm. Joint is 69 mm off, of which it states 26 mm as one sigma
    // with the views' scatter: the photos' tilts of single boards are up to 3 deg off. Kabsch is 66
    // mm off, joint(noise=stated) 43 mm.
    EXPECT_LT((t - Eigen::Vector3d(0.01, -0.13, -0.22)).norm(), 0.075) << t.transpose();
  }
}

TEST(FieldSessions, HallWithAPersonInThePlaneOfTheBoard) {
  SEXTANT_REAL_DATA(folder, "field/vlp16_hall");
  Camera camera{.width_px = 1920,
                .height_px = 1200,
                .fx_px = 1061.37439737547,
                .fy_px = 1061.02435228316,
                .cx_px = 980.706836288949,
                .cy_px = 601.685030610243};
  camera.model = CameraModel::kBrownConrady;
  camera.distortion = {-0.149007007770170, 0.0729485326193990, 0.000257753168848673,
                       -0.000207183134328829};
  const Board board = (*ReadBoards(folder / "board.yaml"))[0];
  const Session session = SessionIn(folder / "*.jpg", folder / "*.pcd");
  for (const Board& described : {board, Exchanged(board)}) {
    const Expected<Calibration> calibration = Calibrate(session, OptionsFor(described, camera));
    ASSERT_TRUE(calibration) << calibration.error().message;
    ASSERT_TRUE(calibration->result) << calibration->result.error().message;
    const Eigen::Vector3d t = calibration->result->cam_from_lidar.translation;
    EXPECT_LT((t - Eigen::Vector3d(-0.030, -0.119, -0.077)).norm(), 0.05) << t.transpose();
  }
}

// Rings without a ring field, and a camera that looks backwards.
TEST(FieldSessions, YardWithACameraThatLooksBackwards) {
  SEXTANT_REAL_DATA(folder, "field/rs16_yard");
  const Camera camera = *ReadCamera(folder / "camera.yaml");
  const Board board = (*ReadBoards(folder / "board.yaml"))[0];
  Eigen::Matrix3d rows;
  rows << -.885, .465, .022, -.039, -.027, -.999, -.464, -.885, .043;
  const Rigid3d expected = Pose(rows, {-0.011, -0.171, 0.047});
  const Session session = SessionIn(folder / "*.png", folder / "*.pcd");
  const Expected<Calibration> calibration =
      Calibrate(session, OptionsFor(Exchanged(board), camera));
  ASSERT_TRUE(calibration) << calibration.error().message;
  EXPECT_EQ(KeptIn(*calibration), 6U) << RowsOf(*calibration);
  ExpectPose(*calibration, expected, {.translation_m = 0.04, .rotation_deg = 0.6});
}

// One view of a board with four round holes and four tags, the scan of a rosette cropped so that
// two sides are missing. Half a turn looks the same to the LiDAR; a rough rotation decides
// between the two.
TEST(FieldSessions, RoundHolesInACroppedScan) {
  SEXTANT_REAL_DATA(folder, "field/mid360_circles");
  const Camera camera = *ReadCamera(folder / "camera.yaml");
  Board board = (*ReadBoards(folder / "board.yaml"))[0];
  for (const double x : {-0.25, 0.25}) {
    for (const double y : {-0.2, 0.2}) board.round_holes.push_back({0.12, {x, y}});
  }
  Eigen::Matrix3d rows;
  rows << .0069, -.9992, .0391, .0113, -.0390, -.9992, .9999, .0073, .0110;
  const Rigid3d expected = Pose(rows, {0.021, -0.087, 0.003});
  const Session session = SessionIn(folder / "image.png", folder / "filtered_cloud.ply");
  CalibrateOptions options = OptionsFor(board, camera);
  options.match.initial = expected;
  const Expected<Calibration> calibration = Calibrate(session, options);
  ASSERT_TRUE(calibration) << calibration.error().message;
  EXPECT_EQ(KeptIn(*calibration), 1U) << RowsOf(*calibration);
  // The pose of the board by both sensors.
  const BoardView& view = calibration->assembly.problem.board_views.at(0);
  const PoseDistance off =
      DistanceBetween(view.cam_from_board * view.lidar_from_board.Inverse(), expected);
  EXPECT_LT(off.translation_m, 0.008);
  EXPECT_LT(off.rotation_rad * kDegPerRad, 0.2);
  // The answer: 1 mm of curvature on the board is no range offset of 60 mm. Its goal is the 8 mm
  // above; joint is 13 mm off, with a stated 34 mm.
  ExpectPose(*calibration, expected, {.translation_m = 0.015, .rotation_deg = 0.3});
  ASSERT_TRUE(calibration->result->covariance);
  const Eigen::Vector3d error =
      calibration->result->cam_from_lidar.translation - expected.translation;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double sigma_m = std::sqrt((*calibration->result->covariance)(axis + 3, axis + 3));
    EXPECT_LT(std::abs(error[axis]), 2.0 * sigma_m) << axis;
  }
}

// The photos of one session with the scans of another: both show such a board, but not the same.
TEST(FieldSessions, PhotosAndScansOfDifferentMomentsGiveNoPose) {
  SEXTANT_REAL_DATA(folder, "field/vlp16_road");
  const Camera camera = *ReadCamera(folder / "camera.yaml");
  const Board board = (*ReadBoards(folder / "board.yaml"))[0];
  Session session = SessionIn(folder / "*.jpg", folder / "*.pcd");
  std::vector<FilePair>& pairs = session.files.pairs;
  const std::filesystem::path first = pairs[0].cloud;
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i) pairs[i].cloud = pairs[i + 1].cloud;
  pairs.back().cloud = first;
  const Expected<Calibration> calibration = Calibrate(session, OptionsFor(board, camera));
  ASSERT_TRUE(calibration) << calibration.error().message;
  ASSERT_FALSE(calibration->result);
  const std::string& message = calibration->result.error().message;
  EXPECT_THAT(message, HasSubstr("no pose"));
  EXPECT_THAT(message, testing::Not(HasSubstr("gathers")));
}

}  // namespace
}  // namespace sextant::test
