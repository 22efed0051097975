// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "e2e/run_sextant.h"
#include "io/cameras/camera_file.h"
#include "support/bag_built.h"
#include "support/run_program.h"

#ifdef SEXTANT_WITH_BAG
#include "io/bag/bag.h"
#include "io/bag/messages.h"
#endif

namespace sextant {
namespace {

namespace fs = std::filesystem;

using test::kBagIsBuilt;
using test::ProgramRun;
using test::ReadText;
using test::RunSextant;
using test::TestFolder;
using testing::HasSubstr;

// Two small cameras that differ, so that swapped topics are noticed.
constexpr const char* kSceneOfTwoCameras = R"(sextant_scene: 1
name: small
lidar: {model: vlp16, pose: {position_m: [0, 0, 1]}}
cameras:
  - name: left
    intrinsics: {model: pinhole, width_px: 160, height_px: 120, fx_px: 90, fy_px: 90, cx_px: 79.5, cy_px: 59.5}
    pose: {position_m: [0, 0.1, 0.9]}
  - name: right
    intrinsics: {model: pinhole, width_px: 128, height_px: 96, fx_px: 70, fy_px: 71, cx_px: 63.5, cy_px: 47.5}
    pose: {position_m: [0, -0.1, 0.9]}
boards:
  - board:
      {id: 0, top_right_m: 0.5, right_bottom_m: 0.5, tags: [{family: tag36h11, id: 3, edge_m: 0.3}]}
    pose: {position_m: [2, 0.4, 1], yaw_deg: 10, pitch_deg: 5, roll_deg: 45}
    swing: {axis_in_world: [0, 1, 0], amplitude_deg: 5, period_s: 1.3}
)";

ProgramRun Simulate(const fs::path& out, const std::string& options) {
  const fs::path scene = TestFolder() / "scene.yaml";
  test::WriteText(scene, kSceneOfTwoCameras);
  return RunSextant("simulate " + scene.string() + " --out " + out.string() + " " + options);
}

TEST(SimulateBag, HoldsEveryScanWithItsImagesAndCameras) {
  SKIP_WHERE_NOT_BUILT();
  const fs::path out = TestFolder() / "session";
  const ProgramRun run = Simulate(out, "--scans 3 --interval 0.5 --bag");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("session.bag"));
  const ProgramRun bag = RunSextant("bag " + (out / "session.bag").string());
  ASSERT_EQ(bag.exit_code, 0) << bag.err;
  EXPECT_THAT(bag.out, HasSubstr("ROS 1 bag, 5 topics, 15 messages, 1.000 s from 1970-01-01 "
                                 "00:00:01 UTC"));
  for (const std::string topic :
       {"/lidar/points +sensor_msgs/PointCloud2", "/left/image_raw +sensor_msgs/Image",
        "/left/camera_info +sensor_msgs/CameraInfo", "/right/image_raw +sensor_msgs/Image",
        "/right/camera_info +sensor_msgs/CameraInfo"}) {
    EXPECT_THAT(bag.out, testing::ContainsRegex(topic + " +3 +1.000 +2.0"));
  }
  for (const std::string camera : {"left", "right"}) {
    EXPECT_THAT(bag.out, HasSubstr("/lidar/points with /" + camera +
                                   "/image_raw, within 0.05 s: 3 pairs (apart: median 0.000 ms, at "
                                   "most 0.000 ms); without a partner: 0 scans, 0 images"));
  }
}

TEST(SimulateBag, ItsMessagesAreTheSessionsFiles) {
  SKIP_WHERE_NOT_BUILT();
  const fs::path out = TestFolder() / "session";
  const fs::path extracted = TestFolder() / "extracted";
  ASSERT_EQ(Simulate(out, "--scans 2 --bag").exit_code, 0);
  const ProgramRun run =
      RunSextant("bag " + (out / "session.bag").string() + " --extract " + extracted.string());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  // Second scan: a second after the first, which is a second after ROS's zero.
  const std::string name = "000001_2000000000";
  EXPECT_EQ(ReadText(extracted / "lidar_points" / (name + ".pcd")), ReadText(out / "scan_001.pcd"));
  for (const std::string camera : {"left", "right"}) {
    EXPECT_EQ(ReadText(extracted / (camera + "_image_raw") / (name + ".png")),
              ReadText(out / (camera + "_001.png")));
    // The first message alone: the camera stays the same.
    const Expected<Camera> recorded =
        ReadCamera(extracted / (camera + "_camera_info") / "000000_1000000000.yaml");
    const Expected<Camera> written = ReadCamera(out / (camera + "_info.yaml"));
    ASSERT_TRUE(recorded && written);
    EXPECT_EQ(FormatCameraInfo(*recorded, camera), FormatCameraInfo(*written, camera));
  }
}

#ifdef SEXTANT_WITH_BAG
TEST(SimulateBag, EveryMessageHasItsFrameAndItsScansTime) {
  const fs::path out = TestFolder() / "session";
  ASSERT_EQ(Simulate(out, "--scans 2 --interval 0.25 --bag").exit_code, 0);
  const Expected<std::unique_ptr<Bag>> bag = OpenBag(out / "session.bag");
  ASSERT_TRUE(bag) << bag.error().message;
  std::vector<std::string> seen;
  const Expected<void> read = (*bag)->Read({0, 1, 2, 3, 4}, [&](const BagMessage& message) {
    const Expected<MessageHeader> header = DecodeHeader(message);
    if (!header) return Expected<void>(tl::unexpected<Error>(header.error()));
    EXPECT_EQ(header->stamp_ns, message.time_ns);
    EXPECT_EQ(header->stamp_ns, seen.size() < 5 ? 1'000'000'000 : 1'250'000'000);
    seen.push_back(message.topic->name + " " + header->frame);
    return Expected<void>();
  });
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(seen.size(), 10U);
  const std::vector<std::string> expected = {
      "/lidar/points lidar", "/left/image_raw left_optical", "/left/camera_info left_optical",
      "/right/image_raw right_optical", "/right/camera_info right_optical"};
  EXPECT_EQ(std::vector(seen.begin(), seen.begin() + 5), expected);
  EXPECT_EQ(std::vector(seen.begin() + 5, seen.end()), expected);
}
#endif

TEST(SimulateBag, TheSameSeedGivesTheSameBytesInOneGoOrLater) {
  SKIP_WHERE_NOT_BUILT();
  const fs::path whole = TestFolder() / "whole";
  const fs::path later = TestFolder() / "later";
  const fs::path other = TestFolder() / "other";
  ASSERT_EQ(Simulate(whole, "--scans 2 --seed 4 --bag").exit_code, 0);
  ASSERT_EQ(Simulate(later, "--seed 4 --bag").exit_code, 0);
  const std::string one_scan = ReadText(later / "session.bag");
  EXPECT_NE(one_scan, ReadText(whole / "session.bag"));
  ASSERT_EQ(Simulate(later, "--scans 2 --seed 4").exit_code, 0);
  ASSERT_EQ(Simulate(later, "--scans 2 --seed 4 --bag").exit_code, 0);
  EXPECT_EQ(ReadText(later / "session.bag"), ReadText(whole / "session.bag"));
  ASSERT_EQ(Simulate(other, "--seed 5 --bag").exit_code, 0);
  EXPECT_NE(ReadText(other / "session.bag"), one_scan);
}

TEST(SimulateBag, AFileThatWasChangedIsRefusedAndNoBagAppears) {
  SKIP_WHERE_NOT_BUILT();
  const fs::path out = TestFolder() / "session";
  ASSERT_EQ(Simulate(out, "").exit_code, 0);
  test::WriteText(out / "left_000.png", "no image");
  const ProgramRun run = Simulate(out, "--bag");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("left_000.png: expected an image"));
  for (const auto& entry : fs::directory_iterator(out)) {
    EXPECT_EQ(entry.path().filename().string().find("session.bag"), std::string::npos);
  }
}

TEST(SimulateBag, WhatCannotBeRecordedIsRefusedBeforeAnythingIsWritten) {
  const auto refusal = [](const std::string& options) {
    const fs::path out = TestFolder() / "session";
    const ProgramRun run = Simulate(out, "--bag " + options);
    EXPECT_EQ(run.exit_code, 2) << options;
    EXPECT_FALSE(fs::exists(out)) << options;
    return run.err;
  };
  if (!kBagIsBuilt) {
    EXPECT_THAT(refusal(""), HasSubstr("configure with -DSEXTANT_BAG=ON"));
    return;
  }
  EXPECT_THAT(refusal("--level corners"), HasSubstr("--bag: only the level full"));
  EXPECT_THAT(refusal("--scans 5000 --interval 1e6"), HasSubstr("--bag: ROS counts time up to"));
}

}  // namespace
}  // namespace sextant
