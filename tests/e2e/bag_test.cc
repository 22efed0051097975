// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "e2e/run_sextant.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/cloud_file.h"
#include "support/bag_built.h"
#include "support/real_data.h"
#include "support/run_program.h"
#include "support/source_tree.h"
#ifdef SEXTANT_WITH_BAG
#include "io/bag/rosbag1_writer.h"
#endif

namespace sextant {
namespace {

using test::kBagIsBuilt;
using test::ProgramRun;
using test::TestFolder;
using testing::HasSubstr;

ProgramRun RunBag(const std::string& arguments) { return test::RunSextant("bag " + arguments); }

std::string Seed(const std::string& name) {
  return (test::SourceRoot() / "tests/fuzz/corpus" / name).string();
}

// The seed has a scan, an image of 2 x 2 and an encoded image, all with one time stamp.
TEST(BagCommand, ListsTopicsAndPairs) {
  SKIP_WHERE_NOT_BUILT();
  const ProgramRun run = RunBag(Seed("rosbag1/lz4"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("ROS 1 bag, 3 topics, 3 messages, 0.000 s from 1970-01-01"));
  EXPECT_THAT(run.out, HasSubstr("sensor_msgs/PointCloud2"));
  EXPECT_THAT(run.out, HasSubstr("/p with /i, within 0.05 s: 1 pairs"));
  EXPECT_THAT(run.out, HasSubstr("/p with /c"));
  EXPECT_THAT(run.out, HasSubstr("without a partner: 0 scans, 0 images"));
}

TEST(BagCommand, ExtractsFilesThatOtherCommandsRead) {
  SKIP_WHERE_NOT_BUILT();
  const std::filesystem::path folder = TestFolder() / "out";
  const ProgramRun run = RunBag(Seed("rosbag1/none") + " --extract " + folder.string());
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const Expected<PointCloud> scan = ReadCloud(folder / "p/000000_5000000007.pcd");
  ASSERT_TRUE(scan) << scan.error().message;
  EXPECT_EQ(scan->points[1], Eigen::Vector3d(4, 5, 6));
  EXPECT_THAT(test::ReadText(folder / "i/000000_5000000007.png"), HasSubstr("PNG"));
  EXPECT_EQ(test::ReadText(folder / "c/000000_5000000007.jpg"), "\xff\xd8\xff");
  EXPECT_EQ(test::ReadText(folder / "pairs.csv"),
            "scan,image,image_less_scan_s\n"
            "p/000000_5000000007.pcd,i/000000_5000000007.png,0.000000000\n"
            "p/000000_5000000007.pcd,c/000000_5000000007.jpg,0.000000000\n");
}

#ifdef SEXTANT_WITH_BAG
TEST(BagCommand, PairsNameEachImageByItsOwnFormat) {
  const std::string path = test::TestPath("mixed.bag");
  Expected<Rosbag1Writer> writer = Rosbag1Writer::Create(path);
  ASSERT_TRUE(writer) << writer.error().message;
  for (int i = 0; i < 2; ++i) {
    const std::int64_t stamp = (i + 1) * 1'000'000'000LL;
    CloudMessage scan{{stamp, "lidar"}, {}};
    scan.cloud.points.emplace_back(1.0, 2.0, 3.0);
    EncodedImageMessage image;
    image.header = {stamp, "cam"};
    image.data = i == 0 ? "\xff\xd8\xff" : "\x89PNG";
    ASSERT_TRUE(writer->Write("/p", stamp, scan));
    ASSERT_TRUE(writer->Write("/c", stamp, image));
  }
  ASSERT_TRUE(writer->Close());
  const std::filesystem::path folder = TestFolder() / "out";
  const ProgramRun run = RunBag(path + " --extract " + folder.string());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(test::ReadText(folder / "pairs.csv"),
            "scan,image,image_less_scan_s\n"
            "p/000000_1000000000.pcd,c/000000_1000000000.jpg,0.000000000\n"
            "p/000001_2000000000.pcd,c/000001_2000000000.png,0.000000000\n");
  EXPECT_TRUE(std::filesystem::exists(folder / "c/000001_2000000000.png"));
}
#endif

TEST(BagCommand, CameraInfoIsWrittenAsAFileThatIsReadBack) {
  SKIP_WHERE_NOT_BUILT();
  const std::filesystem::path folder = TestFolder() / "out";
  const ProgramRun run = RunBag(Seed("mcap/zstd") + " --extract " + folder.string());
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const Expected<Camera> camera = ReadCamera(folder / "info/000000_5000000007.yaml");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->model, CameraModel::kBrownConrady);
  EXPECT_EQ(camera->distortion[0], 0.1);
  EXPECT_EQ(camera->cx_px, 320.0);
}

TEST(BagCommand, ALinkThatLeadsOutOfTheFolderIsRefused) {
  SKIP_WHERE_NOT_BUILT();
  namespace fs = std::filesystem;
  fs::create_directories(TestFolder() / "elsewhere");
  fs::create_directories(TestFolder() / "out");
  fs::create_directory_symlink(TestFolder() / "elsewhere", TestFolder() / "out" / "p");
  const ProgramRun run =
      RunBag(Seed("rosbag1/none") + " --extract " + (TestFolder() / "out").string());
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("it is a link to "));
  EXPECT_TRUE(fs::is_empty(TestFolder() / "elsewhere"));
}

TEST(BagCommand, ExtractsARealRecording) {
  SKIP_WHERE_NOT_BUILT();
  SEXTANT_REAL_DATA(bag, "fiducials/aruco_images.bag");
  const std::filesystem::path folder = TestFolder() / "out";
  const ProgramRun run = RunBag(bag.string() + " --extract " + folder.string());
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("No pairs: it takes a topic of scans"));
  // One image, one camera for all its 15 messages, pairs.csv.
  EXPECT_THAT(run.out, HasSubstr(": 3 files"));
}

TEST(BagCommand, RefusesAFileThatIsNoRecordingOrNamesWhatToInstall) {
  const ProgramRun run = RunBag(Seed("ply/ascii"));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err,
              HasSubstr(kBagIsBuilt ? "byte 0: expected a recording" : "with -DSEXTANT_BAG=ON"));
  EXPECT_EQ(RunBag("/none.bag").exit_code, 2);
}

}  // namespace
}  // namespace sextant
