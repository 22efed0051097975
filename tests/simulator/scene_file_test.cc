// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "simulator/session/validate_scene.h"
#include "support/bad_text.h"
#include "support/source_tree.h"

namespace sextant {
namespace {

using test::BadText;

constexpr ErrorCode kParse = ErrorCode::kParse;
constexpr ErrorCode kInvalid = ErrorCode::kInvalidInput;

// A scene with one board 2 m in front of a LiDAR and a camera, in which lines can be replaced.
struct Parts {
  std::string lidar = "{model: vlp16, pose: {position_m: [0, 0, 1]}}";
  std::string camera = "{model: pinhole, pose: {position_m: [0, 0.1, 1]}}";
  std::string board = "id: 0, top_right_m: 0.5, right_bottom_m: 0.5";
  std::string pose = "position_m: [2, 0, 1], roll_deg: 45";
  std::string more{};
};

std::string SceneText(const Parts& parts) {
  return "sextant_scene: 1\nlidar: " + parts.lidar + "\ncameras:\n  - " + parts.camera +
         "\nboards:\n  - board: {" + parts.board + "}\n    pose: {" + parts.pose + "}\n" +
         parts.more;
}

TEST(SceneFile, PosesFollowTheirDescription) {
  const auto scene = ParseScene(
      SceneText({.pose = "position_m: [2, 0, 1], facing_m: [0, 0, 1], roll_deg: 45"}), "s");
  ASSERT_TRUE(scene) << scene.error().message;
  const Rigid3d& world_from_cam = scene->cameras[0].world_from_cam;
  EXPECT_TRUE((world_from_cam.rotation * Eigen::Vector3d::UnitZ())
                  .isApprox(Eigen::Vector3d::UnitX(), 1e-12));
  EXPECT_TRUE((world_from_cam.rotation * Eigen::Vector3d::UnitY())
                  .isApprox(-Eigen::Vector3d::UnitZ(), 1e-12));
  // Rotated clockwise by 45 degrees, corner 0 is up.
  const Eigen::Vector3d top =
      scene->boards[0].world_from_board * Eigen::Vector3d(-0.25, -0.25, 0.0);
  EXPECT_TRUE(top.isApprox(Eigen::Vector3d(2, 0, 1 + 0.25 * std::sqrt(2.0)), 1e-12)) << top;
}

TEST(SceneFile, AnglesRotateInTheDocumentedDirection) {
  const auto scene = ParseScene(
      SceneText({.lidar = "{pose: {position_m: [0, 0, 1], yaw_deg: 90}}",
                 .camera = "{model: pinhole, pose: {position_m: [0, 0, 1], pitch_deg: 10}}"}),
      "s");
  ASSERT_TRUE(scene) << scene.error().message;
  const Eigen::Vector3d ahead = scene->lidar.world_from_lidar.rotation * Eigen::Vector3d::UnitX();
  EXPECT_TRUE(ahead.isApprox(Eigen::Vector3d::UnitY(), 1e-12)) << ahead;
  EXPECT_LT((scene->cameras[0].world_from_cam.rotation * Eigen::Vector3d::UnitZ()).z(), -0.1);
}

TEST(SceneFile, FacingPutsThePointOnTheAxis) {
  const auto scene = ParseScene(
      SceneText({.camera = "{model: pinhole, pose: {position_m: [0.3, 0.1, 1.2], facing_m: "
                           "[2, -0.2, 0.9]}}",
                 .pose = "position_m: [2, 0, 1], facing_m: [0.3, 0.1, 1.2], roll_deg: 10"}),
      "s");
  ASSERT_TRUE(scene) << scene.error().message;
  const Eigen::Vector3d in_cam =
      scene->cameras[0].world_from_cam.Inverse() * Eigen::Vector3d(2, -0.2, 0.9);
  EXPECT_NEAR(in_cam.head<2>().norm(), 0.0, 1e-12);
  EXPECT_GT(in_cam.z(), 0.0);
  const Eigen::Vector3d in_board =
      scene->boards[0].world_from_board.Inverse() * Eigen::Vector3d(0.3, 0.1, 1.2);
  EXPECT_NEAR(in_board.head<2>().norm(), 0.0, 1e-12);
  EXPECT_LT(in_board.z(), 0.0);
}

TEST(SceneFile, AStereoCameraBecomesTwoCameras) {
  const auto scene =
      ParseScene(SceneText({.camera = "{name: zed, model: zed_left, stereo_baseline_m: 0.12, pose: "
                                      "{position_m: [0, 0, 1]}}"}),
                 "s");
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->cameras.size(), 2U);
  EXPECT_EQ(scene->cameras[1].name, "zed_right");
  EXPECT_TRUE(
      scene->cameras[1].world_from_cam.translation.isApprox(Eigen::Vector3d(0, -0.12, 1), 1e-12));
}

class SceneOfTheSet : public testing::TestWithParam<std::string> {};

TEST_P(SceneOfTheSet, CanBeSimulated) {
  const auto scene = ReadScene(test::SourceRoot() / "experiments/scenes" / GetParam());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->name + ".yaml", GetParam());
  const Expected<void> valid = ValidateScene(*scene);
  EXPECT_TRUE(valid) << valid.error().message;
}

std::vector<std::string> ScenesOfTheSet() {
  std::vector<std::string> names;
  for (const auto& entry :
       std::filesystem::directory_iterator(test::SourceRoot() / "experiments/scenes")) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Scenes, SceneOfTheSet, testing::ValuesIn(ScenesOfTheSet()),
                         [](const auto& name) {
                           return name.param.substr(0, name.param.find('.'));
                         });

// Not a test parameter, as the text would be printed at every start of the binary.
TEST(SceneFile, RejectsAMillionBoards) {
  const auto expect_refused = [](int more_boards, const char* message) {
    const std::string text = SceneText({}) + test::Repeated("  - {}\n", more_boards);
    ExpectRefused(ParseScene(text, "s"), BadText{"Boards", "", ErrorCode::kParse, message});
  };
  expect_refused(1000, "s:6: boards: expected at most 1000, got 1001");
  expect_refused(1'000'000, "not valid YAML: too many values for a text of this size");
}

class BadSceneTest : public testing::TestWithParam<BadText> {};

TEST_P(BadSceneTest, IsRejectedBeforeAnyWork) {
  const Expected<Scene> scene = ParseScene(GetParam().text, "s");
  if (!scene) {
    ExpectRefused(scene, GetParam());
  } else {
    ExpectRefused(ValidateScene(*scene), GetParam());
  }
}

std::string WithBoard(const std::string& board) { return SceneText({.board = board}); }
std::string WithPose(const std::string& pose) { return SceneText({.pose = pose}); }
std::string WithMore(const std::string& more) { return SceneText({.more = more}); }
std::string WithCamera(const std::string& camera) { return SceneText({.camera = camera}); }

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadSceneTest,
    testing::Values(
        BadText{"Empty", "", kParse, "s:1: the file is empty"},
        BadText{"Version", "sextant_scene: 2\n", kParse, "s:1: sextant_scene"},
        BadText{"UnknownKey", WithMore("wall: []\n"), kParse,
                "unknown key 'wall'; did you mean 'walls'?"},
        BadText{"UnknownPoseKey", WithPose("position_m: [2, 0, 1], rol_deg: 45"), kParse,
                "s:7: pose: unknown key 'rol_deg'; did you mean 'roll_deg'?"},
        BadText{"TwoRotations", WithPose("position_m: [2, 0, 1], yaw_deg: 1, facing_m: [0, 0, 0]"),
                kParse, "s:7: pose: expected one of"},
        BadText{"LongQuaternion", WithPose("position_m: [2, 0, 1], quaternion_wxyz: [1, 1, 0, 0]"),
                kParse, "expected a quaternion of length 1"},
        BadText{"FacingItself", WithPose("position_m: [2, 0, 1], facing_m: [2, 0, 1]"), kParse,
                "expected another point than position_m"},
        BadText{"NotFinite", WithPose("position_m: [.inf, 0, 1]"), ErrorCode::kNonFinite,
                "s:7: position_m"},
        BadText{"NoBoards",
                "sextant_scene: 1\nlidar: {pose: {position_m: [0, 0, 1]}}\ncameras: [{model: "
                "pinhole, pose: {position_m: [0, 0, 1]}}]\n",
                kInvalid, "boards: expected at least one"},
        BadText{"NoCamera",
                "sextant_scene: 1\nlidar: {pose: {position_m: [0, 0, 1]}}\nboards: [{board: {id: "
                "0, top_right_m: 1, right_bottom_m: 1}, pose: {position_m: [2, 0, 1]}}]\n",
                kInvalid, "cameras: expected at least one"},
        BadText{"NegativeBoard", WithBoard("id: 0, top_right_m: -0.5, right_bottom_m: 0.5"), kParse,
                "s:6: board: top_right_m: expected more than zero"},
        BadText{"NegativeWall",
                WithMore("walls: [{width_m: -1, height_m: 1, pose: {position_m: [9, 0, 1]}}]\n"),
                kInvalid, "wall 0: width_m is -1, expected more than zero"},
        BadText{"NegativeBox",
                WithMore("boxes: [{size_m: [1, -1, 1], pose: {position_m: [9, 0, 1]}}]\n"),
                kInvalid, "box 0: size_m is -1"},
        BadText{"NegativeCylinder",
                WithMore("cylinders: [{base_m: [9, 0, 0], radius_m: 0, height_m: 1}]\n"), kInvalid,
                "cylinder 0: radius_m is 0"},
        BadText{"BehindTheCamera", WithPose("position_m: [-2, 0, 1], facing_m: [0, 0, 1]"),
                kInvalid, "board 0: no camera sees it: it is behind camera 'cam'"},
        BadText{"OutsideTheImage", WithPose("position_m: [2, 4, 1], facing_m: [0, 0, 1]"), kInvalid,
                "board 0: no camera sees it: it is outside the image of camera 'cam'"},
        BadText{"BackToTheCamera", WithPose("position_m: [2, 0, 1], yaw_deg: 180"), kInvalid,
                "board 0: no camera sees it: its back faces camera 'cam'"},
        BadText{"AboveTheLidar",
                SceneText({.camera = "{model: pinhole, pose: {position_m: [0, 0, 1], pitch_deg: "
                                     "-40}}",
                           .pose = "position_m: [1.5, 0, 2.8], facing_m: [0, 0, 1]"}),
                kInvalid, "board 0: the LiDAR does not see it"},
        BadText{"BeyondTheRange", WithPose("position_m: [500, 0, 1]"), kInvalid,
                "board 0: the LiDAR does not see it"},
        BadText{"ThroughTheFloor",
                SceneText({.pose = "position_m: [2, 0, 0.3], roll_deg: 45",
                           .more = "walls: [{name: floor, width_m: 9, height_m: 9, pose: "
                                   "{position_m: [0, 0, 0], pitch_deg: 90}}]\n"}),
                kInvalid, "board 0: it intersects wall 'floor'"},
        BadText{"SwingsThroughAWall",
                "sextant_scene: 1\nlidar: {pose: {position_m: [0, 0, 1]}}\ncameras: [{model: "
                "pinhole, pose: {position_m: [0, 0, 1]}}]\nboards: [{board: {id: 0, top_right_m: "
                "0.5, right_bottom_m: 0.5}, pose: {position_m: [2, 0, 1]}, swing: {axis_in_world: "
                "[0, 1, 0], amplitude_deg: 40, period_s: 1}}]\nwalls: [{name: back, width_m: 9, "
                "height_m: 3, pose: {position_m: [2.2, 0, 1]}}]\n",
                kInvalid, "board 0: it intersects wall 'back'"},
        BadText{"InABox",
                WithMore("boxes: [{name: crate, size_m: [1, 1, 1], pose: {position_m: [2, 0.4, "
                         "1]}}]\n"),
                kInvalid, "board 0: it intersects box 'crate'"},
        BadText{"ThroughAPerson",
                WithMore("cylinders: [{name: person, base_m: [2, 0.3, 0], radius_m: 0.25, "
                         "height_m: 1.75}]\n"),
                kInvalid, "board 0: it intersects cylinder 'person'"},
        BadText{"CameraInAWall",
                WithMore("walls: [{name: near, width_m: 9, height_m: 9, pose: {position_m: [0.005, "
                         "0, 1], yaw_deg: 0}}]\n"),
                kInvalid, "it is inside wall 'near'"},
        BadText{"CameraInABox",
                WithMore("boxes: [{size_m: [0.1, 0.1, 0.1], pose: {position_m: [0, 0.12, 1]}}]\n"),
                kInvalid, "camera 'cam': it is inside box 0"},
        BadText{"TagId",
                WithBoard("id: 0, top_right_m: 0.5, right_bottom_m: 0.5, tags: [{family: "
                          "aruco_4x4_50, id: 50, edge_m: 0.2}]"),
                kInvalid, "tag id 50 is out of range: aruco_4x4_50 has the ids 0 to 49"},
        BadText{"TagFamily",
                WithBoard("id: 0, top_right_m: 0.5, right_bottom_m: 0.5, tags: [{family: "
                          "tag36h12, id: 0, edge_m: 0.2}]"),
                ErrorCode::kUnknownName, "did you mean 'tag36h11'?"},
        BadText{"LidarModel", SceneText({.lidar = "{model: vlp61, pose: {position_m: [0, 0, 1]}}"}),
                ErrorCode::kUnknownName, "did you mean 'vlp16'?"},
        BadText{"CameraModel", WithCamera("{model: zed, pose: {position_m: [0, 0, 1]}}"),
                ErrorCode::kUnknownName, "zed"},
        BadText{"CameraOfTwoMinds",
                WithCamera("{model: zed_left, intrinsics: {}, pose: {position_m: [0, 0, 1]}}"),
                kParse, "expected either model or intrinsics"},
        BadText{"NoResolution",
                WithCamera("{intrinsics: {model: pinhole, width_px: 0, height_px: 720, fx_px: 7, "
                           "fy_px: 7, cx_px: 1, cy_px: 1}, pose: {position_m: [0, 0, 1]}}"),
                kInvalid, "camera 'cam': an image of 0 x 720 px cannot be rendered"},
        BadText{"CameraNamesAPath",
                WithCamera("{name: ../cam, model: pinhole, pose: {position_m: [0, 0, 1]}}"), kParse,
                "s:4: name: expected a name for a file: letters"}),
    [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace sextant
