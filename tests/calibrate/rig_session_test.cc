// SPDX-License-Identifier: Apache-2.0
#include "calibrate/session/rig_session.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "calibrate/session/session.h"
#include "support/scratch_folder.h"

namespace sextant {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class RigSessionFiles : public testing::Test {
 protected:
  std::filesystem::path At(const std::string& name) const { return folder_.path() / name; }

  void Write(const std::string& name, const std::string& text = "") const {
    std::filesystem::create_directories(At(name).parent_path());
    std::ofstream(At(name)) << text;
  }

  test::ScratchFolder folder_;
};

TEST_F(RigSessionFiles, MomentsAreWhatWasRecordedTogether) {
  for (const char* name : {"left/l_1.png", "left/l_2.png", "left/l_10.png", "top/scan_001.pcd",
                           "top/scan_010.pcd", "right/r_2.png", "right/r_3.png"}) {
    Write(name);
  }
  Write("session.yaml", R"(sextant_session: 1
boards: boards.yaml
root: top
sensors:
  - {name: left, camera: l.yaml, images: left/*.png}
  - {name: right, camera: r.yaml, images: right/*.png}
  - {name: top, clouds: top/*.pcd}
)");
  const auto session = ReadRigSession(folder_.path());
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(*session);
  EXPECT_EQ((*session)->root, 2U);
  ASSERT_EQ((*session)->moments.size(), 4U);
  EXPECT_EQ((*session)->moments[0].name, "1");
  EXPECT_THAT((*session)->moments[0].files,
              ElementsAre(At("left/l_1.png"), std::filesystem::path(), At("top/scan_001.pcd")));
  EXPECT_EQ((*session)->moments[3].files[2], At("top/scan_010.pcd"));
  const auto one = ReadSession(folder_.path());
  ASSERT_FALSE(one);
  EXPECT_THAT(one.error().message, HasSubstr("several sensors"));
}

TEST_F(RigSessionFiles, StarsInFoldersDistinguishMoments) {
  for (const char* name : {"day_2/left.png", "day_10/left.png", "day_2/top.pcd", "day_10/top.pcd",
                           "day_10/other.txt"}) {
    Write(name);
  }
  const auto files = ExpandPattern(At("day_*/left.png"));
  ASSERT_TRUE(files) << files.error().message;
  EXPECT_THAT(*files, ElementsAre(At("day_2/left.png"), At("day_10/left.png")));
  const FilePairs pairs = PairFiles(*files, *ExpandPattern(At("day_*/*.pcd")));
  ASSERT_EQ(pairs.pairs.size(), 2U);
  EXPECT_EQ(pairs.pairs[0].name, "2");
  EXPECT_EQ(pairs.pairs[1].cloud, At("day_10/top.pcd"));
}

TEST_F(RigSessionFiles, ASessionFileMayHaveAnyName) {
  Write("a.pcd");
  Write("b.pcd");
  for (const char* name : {"drive", "drive.txt", "drive.YAML"}) {
    Write(name,
          "sextant_session: 1\nsensors:\n  - {name: a, clouds: a.pcd}\n"
          "  - {name: b, clouds: b.pcd}\n");
    const auto session = ReadRigSession(At(name));
    ASSERT_TRUE(session) << session.error().message;
    EXPECT_TRUE(*session) << name;
  }
}

TEST_F(RigSessionFiles, OneCameraIsNoRig) {
  Write("a.png");
  Write("a.pcd");
  Write("session.yaml", "sextant_session: 1\nimages: a.png\nclouds: a.pcd\n");
  const auto session = ReadRigSession(folder_.path());
  ASSERT_TRUE(session);
  EXPECT_FALSE(*session);
}

TEST_F(RigSessionFiles, ASensorNeedsItsFilesAndACameraItsIntrinsics) {
  Write("a.png");
  Write("a.pcd");
  Write("session.yaml", "sextant_session: 1\nsensors:\n  - {name: left, images: a.png}\n");
  const auto session = ReadRigSession(folder_.path());
  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().message, HasSubstr("images with camera"));
}

}  // namespace
}  // namespace sextant
