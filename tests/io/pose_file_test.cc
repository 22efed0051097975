// SPDX-License-Identifier: Apache-2.0
// Poses of every form: what export writes is read back, and the direction is never guessed.
#include "io/poses/pose_file.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/so3.h"
#include "io/export/export_transform.h"
#include "support/calibration_result.h"

namespace sextant {
namespace {

using testing::HasSubstr;

// A camera that looks along the LiDAR's x axis, turned by a few degrees.
Rigid3d ForwardPose() {
  Eigen::Matrix3d axes;
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return {ExpSo3({0.05, -0.03, 0.02}) * Eigen::Quaterniond(axes), {0.05, -0.12, -0.08}};
}

CalibrationResult ForwardResult() {
  CalibrationResult result = test::FullCalibrationResult();
  result.cam_from_lidar = ForwardPose();
  return result;
}

void ExpectPose(const std::string& text, std::optional<PoseDirection> asked = std::nullopt,
                const Rigid3d& expected = ForwardPose(), double tolerance = 1e-12) {
  const Expected<StatedPose> pose = ParsePose(text, "pose");
  ASSERT_TRUE(pose) << pose.error().message << "\n" << text;
  const Expected<Rigid3d> cam_from_lidar = CamFromLidar(*pose, asked, "pose");
  ASSERT_TRUE(cam_from_lidar) << cam_from_lidar.error().message << "\n" << text;
  EXPECT_LT(PoseDifference(*cam_from_lidar, expected).norm(), tolerance) << text;
}

std::string ErrorOf(const std::string& text, std::optional<PoseDirection> asked = std::nullopt) {
  const Expected<StatedPose> pose = ParsePose(text, "pose.txt");
  if (!pose) return pose.error().message;
  const Expected<Rigid3d> cam_from_lidar = CamFromLidar(*pose, asked, "pose.txt");
  return cam_from_lidar ? "" : cam_from_lidar.error().message;
}

TEST(PoseFile, ReadsBackEveryExport) {
  for (const ExportFormat& format : ExportFormats()) {
    for (const bool lidar_is_parent : {true, false}) {
      if (!format.has_parent && !lidar_is_parent) continue;
      // The last names say nothing; the comment of an export does.
      for (const auto& [camera, lidar] :
           {std::pair("cam0_optical", "velodyne"), std::pair("eye", "top")}) {
        SCOPED_TRACE(fmt::format("{} {} {}", format.name, lidar_is_parent, camera));
        const Expected<std::string> text = ExportTransform(
            format.name, ForwardResult(),
            {.camera_frame = camera, .lidar_frame = lidar, .lidar_is_parent = lidar_is_parent});
        ASSERT_TRUE(text);
        ExpectPose(*text);
        const bool is_inverse = format.has_parent && lidar_is_parent;
        const auto [stated, other] =
            is_inverse ? std::pair(PoseDirection::kLidarFromCam, PoseDirection::kCamFromLidar)
                       : std::pair(PoseDirection::kCamFromLidar, PoseDirection::kLidarFromCam);
        ExpectPose(*text, stated);
        EXPECT_THAT(ErrorOf(*text, other), HasSubstr("contradicts"));
      }
    }
  }
}

TEST(PoseFile, ReadsResults) {
  ExpectPose(FormatCalibrationResult(ForwardResult()));
  ExpectPose(FormatCalibrationResultJson(ForwardResult()));
  const Expected<StatedPose> pose = ParsePose(FormatCalibrationResult(ForwardResult()), "r");
  ASSERT_TRUE(pose);
  EXPECT_TRUE(pose->is_result);
}

std::string Rows(const Rigid3d& pose, int rows) {
  const Eigen::Matrix4d m = pose.Matrix();
  std::string text;
  for (int i = 0; i < rows; ++i) {
    text += fmt::format("{} {} {} {}\n", m(i, 0), m(i, 1), m(i, 2), m(i, 3));
  }
  return text;
}

std::string Seven(const Rigid3d& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return fmt::format("# x y z qx qy qz qw\n{} {} {} {} {} {} {}\n", t.x(), t.y(), t.z(), q.x(),
                     q.y(), q.z(), q.w());
}

TEST(PoseFile, NumbersAloneAreRecognisedByAnUprightCamera) {
  for (const int rows : {3, 4}) {
    ExpectPose(Rows(ForwardPose(), rows));
    ExpectPose(Rows(ForwardPose().Inverse(), rows));
  }
  ExpectPose(Seven(ForwardPose()));
  ExpectPose(Seven(ForwardPose().Inverse()));
  // What the user states outweighs the axes.
  ExpectPose(Rows(ForwardPose(), 4), PoseDirection::kLidarFromCam, ForwardPose().Inverse());
}

TEST(PoseFile, AsksForTheDirectionThatNothingTells) {
  const Rigid3d sideways{ExpSo3({0.4, 0.2, -0.1}), {0.1, 0.2, 0.3}};
  for (const std::string& text : {Rows(sideways, 4), Seven(sideways)}) {
    EXPECT_THAT(ErrorOf(text), HasSubstr("--pose-is cam_from_lidar or lidar_from_cam"));
    ExpectPose(text, PoseDirection::kCamFromLidar, sideways);
    ExpectPose(text, PoseDirection::kLidarFromCam, sideways.Inverse());
  }
  const std::string unnamed =
      "header: {frame_id: base}\nchild_frame_id: front\ntransform:\n"
      "  translation: {x: 1, y: 2, z: 3}\n  rotation: {x: 0, y: 0, z: 0, w: 1}\n";
  EXPECT_THAT(ErrorOf(unnamed), HasSubstr("the pose of 'front' in 'base'"));
}

TEST(PoseFile, ReadsKittiWithItsRectificationAndOffset) {
  const std::string tr =
      "4.276802385584e-04 -9.999672484946e-01 -8.084491683471e-03 -1.198459927713e-02 "
      "-7.210626507497e-03 8.081198471645e-03 -9.999413164504e-01 -5.403984729748e-02 "
      "9.999738645903e-01 4.859485810390e-04 -7.206933692422e-03 -2.921968648686e-01";
  const std::string p0 = "P0: 718.856 0 607.1928 0 0 718.856 185.2157 0 0 0 1 0\n";
  const std::string p2 =
      "P2: 718.856 0 607.1928 45.38225 0 718.856 185.2157 -0.1130887 0 0 1 0.003779761\n";
  const Expected<StatedPose> pose = ParsePose(p0 + p2 + "Tr: " + tr, "calib.txt", "P2");
  ASSERT_TRUE(pose) << pose.error().message;
  EXPECT_LT(
      (pose->transform.translation - Eigen::Vector3d(0.04795398, -0.05517103, -0.2884147)).norm(),
      1e-5);
  EXPECT_EQ(pose->direction, PoseDirection::kCamFromLidar);
  EXPECT_THAT(ErrorOf(p0 + p2 + "Tr: " + tr), HasSubstr("pose.txt:P2"));
  EXPECT_EQ(ErrorOf(p2 + "Tr_velo_to_cam: " + tr), "");
  for (const char* p : {"0 0 0 1 0 0 0 0 0 0 0 0", "1e-300 0 6 1e300 0 7 1 0 0 0 1 0"}) {
    EXPECT_THAT(ErrorOf("P0: " + std::string(p) + "\nTr: " + tr),
                HasSubstr("P0: expected the 12 numbers of a projection"));
  }
}

TEST(PoseFile, ConnectsFramesOfARobot) {
  const std::string urdf =
      "<robot name='r'>\n<joint name='a' type='fixed'><parent link='base_link'/><child "
      "link='velodyne'/><origin xyz='1 0 2' rpy='0 0 0'/></joint>\n"
      "<joint name='w' type='continuous'><parent link='base_link'/><child link='wheel'/></joint>\n"
      "<joint name='b' type='fixed'><parent link='base_link'/><child link='camera_link'/><origin "
      "xyz='1.5 0 1.5'/></joint>\n<joint name='c' type='fixed'><parent link='camera_link'/><child "
      "link='camera_optical_frame'/><origin rpy='-1.5707963267948966 0 -1.5707963267948966'/>"
      "</joint>\n</robot>\n";
  Eigen::Matrix3d axes;
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  ExpectPose(urdf, std::nullopt, {Eigen::Quaterniond(axes), {0, -0.5, -0.5}}, 1e-9);
}

TEST(PoseFile, ReadsExtrinsicsOfJson) {
  ExpectPose(
      "{\"intrinsics\": {\"K\": [1, 1, 0, 0]}, \"extrinsics\": {\"translation\": [0, 0, 0],\n"
      "\"rotation\": [-0.5, -0.5, 0.5, -0.5]}}",
      std::nullopt, {Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), Eigen::Vector3d::Zero()});
}

std::string Stamped(const char* parent, const char* child, const std::string& rotation) {
  return fmt::format(
      "header: {{frame_id: {}}}\nchild_frame_id: {}\ntransform:\n"
      "  translation: {{x: 0.1, y: 0, z: -0.05}}\n  rotation: {}\n",
      parent, child, rotation);
}

TEST(PoseFile, TakesNoFrameWithXForwardAsOptical) {
  const std::string identity = "{x: 0, y: 0, z: 0, w: 1}";
  const std::string link = Stamped("velodyne", "camera_link", identity);
  EXPECT_THAT(ErrorOf(link), HasSubstr("camera_link has x forward by ROS's convention"));
  EXPECT_THAT(ErrorOf(link), HasSubstr("--pose-is lidar_from_cam"));
  ExpectPose(link, PoseDirection::kLidarFromCam,
             {Eigen::Quaterniond::Identity(), {-0.1, 0.0, 0.05}});
  EXPECT_THAT(ErrorOf("<launch><node type='static_transform_publisher' args='1 0 2 0 0 0 base "
                      "camera_link'/><node type='static_transform_publisher' args='1 0 3 0 0 0 "
                      "base velodyne'/></launch>"),
              HasSubstr("camera_link has x forward"));
  // A frame of any name with the axes of an optical frame, and one that is tilted.
  EXPECT_EQ(ErrorOf(Stamped("velodyne", "cam0", "{x: -0.5, y: 0.5, z: -0.5, w: 0.5}")), "");
  EXPECT_THAT(ErrorOf(Stamped("velodyne", "cam0", "{x: 0.6, y: 0, z: 0, w: 0.8}")),
              HasSubstr("not named an optical frame"));
}

TEST(PoseFile, DoubtsWhatIsImprobable) {
  const Expected<StatedPose> up =
      ParsePose(Stamped("velodyne", "camera_optical_frame", "{x: 0, y: 0, z: 0, w: 1}"), "pose");
  ASSERT_TRUE(up);
  const std::vector<std::string> doubts = DoubtsOf(*up, up->transform);
  ASSERT_EQ(doubts.size(), 1U);
  EXPECT_THAT(doubts.front(), HasSubstr("the optical axis of camera_optical_frame is along"));
  const Rigid3d far{ForwardPose().rotation, {48.0, -55.0, -288.0}};
  ASSERT_EQ(DoubtsOf(StatedPose{}, far).size(), 1U);
  EXPECT_THAT(DoubtsOf(StatedPose{}, far).front(), HasSubstr("in millimetres?"));
  EXPECT_TRUE(DoubtsOf(StatedPose{}, ForwardPose()).empty());
}

TEST(PoseFile, DoubtsADirectionInWhichTheCameraIsNotUpright) {
  const auto doubt = DoubtOfDirection(ForwardPose(), PoseDirection::kLidarFromCam);
  ASSERT_TRUE(doubt);
  EXPECT_THAT(*doubt, HasSubstr("read as cam_from_lidar, it would be"));
  EXPECT_FALSE(DoubtOfDirection(ForwardPose(), PoseDirection::kCamFromLidar));
  EXPECT_TRUE(DoubtOfDirection(ForwardPose().Inverse(), PoseDirection::kCamFromLidar));
  // The axes tell nothing of this one.
  const Rigid3d sideways{ExpSo3({0.4, 0.2, -0.1}), {0.1, 0.2, 0.3}};
  EXPECT_FALSE(DoubtOfDirection(sideways, PoseDirection::kCamFromLidar));
  EXPECT_FALSE(DoubtOfDirection(sideways, PoseDirection::kLidarFromCam));
}

TEST(PoseFile, RefusesSevenNumbersOfUnknownOrder) {
  const std::string other = "0.048 -0.055 -0.288 -0.50032536 -0.49988836 0.50370142 -0.49605548\n";
  EXPECT_THAT(ErrorOf(other), HasSubstr("x y z w, and as w x y z too"));
  EXPECT_THAT(ErrorOf(other, PoseDirection::kCamFromLidar), HasSubstr("# x y z qw qx qy qz"));
  EXPECT_EQ(ErrorOf("# x y z qx qy qz qw\n" + other), "");
  const Eigen::Quaterniond forward(-0.50032536, -0.49988836, 0.50370142, -0.49605548);
  ExpectPose("# x y z qw qx qy qz\n" + other, std::nullopt,
             {forward.normalized(), {0.048, -0.055, -0.288}}, 1e-6);
  // cam_from_lidar of a camera that looks forward: no other order makes it upright.
  const std::string seven = Seven(ForwardPose());
  ExpectPose(seven.substr(seven.find('\n') + 1));
}

TEST(PoseFile, RefusesContradictionsOfOneFile) {
  const std::string pose = "{translation_m: [1, 2, 3], quaternion_wxyz: [1, 0, 0, 0]}\n";
  EXPECT_THAT(ErrorOf("cam_from_lidar: " + pose + "lidar_from_cam: " + pose),
              HasSubstr("cam_from_lidar at line 1 and lidar_from_cam at line 2 contradict"));
  const auto joint = [](const char* parent, const char* child, double x) {
    return fmt::format(
        "<joint type='fixed'><parent link='{}'/><child link='{}'/><origin xyz='{} 0 0' "
        "rpy='-1.5708 0 -1.5708'/></joint>\n",
        parent, child, x);
  };
  const std::string first = "<robot>\n" + joint("velodyne", "camera", 0.1);
  EXPECT_THAT(ErrorOf(first + joint("velodyne", "camera", 0.2) + "</robot>"),
              HasSubstr("at line 3 contradicts that of 'velodyne' and 'camera' at line 2"));
  EXPECT_EQ(ErrorOf(first + joint("velodyne", "camera", 0.1) + "</robot>"), "");
  // What moves beside the way from the LiDAR to the camera does not matter.
  EXPECT_EQ(
      ErrorOf(first + joint("odom", "velodyne", 1) + joint("odom", "velodyne", 2) + "</robot>"),
      "");
}

TEST(PoseFile, AsksWhichOfSeveralMatrices) {
  const Rigid3d second{ForwardPose().rotation, {0.5, 0.0, 0.0}};
  const std::string two = Rows(ForwardPose(), 4) + Rows(second, 4);
  EXPECT_THAT(ErrorOf(two), HasSubstr("has 2 matrices"));
  EXPECT_THAT(ErrorOf(two), HasSubstr("pose.txt:2"));
  EXPECT_EQ(ErrorOf(Rows(second, 4) + Rows(second, 4)), "");
  const Expected<StatedPose> chosen = ParsePose(two, "rts.txt", "2");
  ASSERT_TRUE(chosen) << chosen.error().message;
  EXPECT_LT(PoseDifference(chosen->transform, second).norm(), 1e-12);
  const Expected<StatedPose> none = ParsePose(two, "rts.txt", "3");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("number of a matrix from 1 to 2, got '3'"));
}

// One camera of the truth of a simulated session.
std::string TruthCamera(const std::string& name, const Rigid3d& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return fmt::format(
      "  - camera: {}\n    cam_from_lidar: {{translation_m: [{}, {}, {}], "
      "quaternion_wxyz: [{}, {}, {}, {}]}}\n",
      name, t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z());
}

TEST(PoseFile, ReadsTheTruthOfASimulationByTheCamerasName) {
  const std::string head = "sextant_truth: 1\nscene: small\nseed: 1\ncameras:\n";
  const std::string one = head + TruthCamera("left", ForwardPose());
  ExpectPose(one);
  EXPECT_THAT(ErrorOf(one, PoseDirection::kLidarFromCam), HasSubstr("contradicts"));
  const Rigid3d second{ForwardPose().rotation, {0.5, 0.0, 0.0}};
  const std::string two = one + TruthCamera("right", second);
  EXPECT_THAT(ErrorOf(two), HasSubstr("pose.txt:NAME; there are: left, right"));
  const Expected<StatedPose> chosen = ParsePose(two, "truth.yaml", "right");
  ASSERT_TRUE(chosen) << chosen.error().message;
  EXPECT_LT(PoseDifference(chosen->transform, second).norm(), 1e-12);
  const Expected<StatedPose> none = ParsePose(two, "truth.yaml", "rear");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("has no camera 'rear'; there are: left, right"));
  EXPECT_THAT(ErrorOf(head + "  []\n"), HasSubstr("there are: none"));
  EXPECT_THAT(ErrorOf(head + "  - {camera: left}\n"), HasSubstr("cam_from_lidar"));
}

TEST(PoseFile, RefusesWhatIsNoPose) {
  EXPECT_THAT(ErrorOf("a: 1\n"), HasSubstr("expected a pose"));
  EXPECT_THAT(ErrorOf("<robot></robot>"), HasSubstr("expected a static_transform_publisher"));
  EXPECT_THAT(ErrorOf("<robot>"), HasSubstr("expected XML"));
  EXPECT_THAT(ErrorOf("1 2 3 4 5 6 7\n"), HasSubstr("expected a quaternion of length 1"));
  EXPECT_THAT(ErrorOf("1 0 0 0\n0 1 0 0\n"), HasSubstr("4x4"));
}

}  // namespace
}  // namespace sextant
