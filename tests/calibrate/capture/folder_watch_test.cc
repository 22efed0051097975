// SPDX-License-Identifier: Apache-2.0
#include "calibrate/capture/folder_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/scratch_folder.h"

namespace sextant {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class FolderWatchTest : public testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder_.path() / name).parent_path());
    std::ofstream(folder_.path() / name, std::ios::binary) << text;
  }

  FolderFiles Look() {
    const Expected<FolderFiles> files = watch_.Look();
    EXPECT_TRUE(files) << files.error().message;
    return files ? *files : FolderFiles{};
  }

  static std::vector<std::string> Names(const std::vector<WatchedFile>& files) {
    std::vector<std::string> names;
    for (const WatchedFile& file : files) names.push_back(file.path.filename().string());
    return names;
  }

  test::ScratchFolder folder_;
  FolderWatch watch_{folder_.path()};
};

TEST_F(FolderWatchTest, AFileIsCompleteWhenItNoLongerChanges) {
  EXPECT_THAT(Look().images, IsEmpty());
  Write("a.png", "half");
  FolderFiles files = Look();
  EXPECT_THAT(files.images, IsEmpty());
  EXPECT_EQ(files.unsettled, 1U);
  Write("a.png", "half and the rest");
  files = Look();
  EXPECT_THAT(files.images, IsEmpty());
  EXPECT_EQ(files.unsettled, 1U);
  files = Look();
  EXPECT_THAT(Names(files.images), ElementsAre("a.png"));
  EXPECT_EQ(files.unsettled, 0U);
  // Written again: it is new once more.
  Write("a.png", "another");
  EXPECT_THAT(Look().images, IsEmpty());
  EXPECT_THAT(Names(Look().images), ElementsAre("a.png"));
}

TEST_F(FolderWatchTest, EmptyHiddenAndOtherFilesDoNotCount) {
  Write("empty.pcd", "");
  Write(".partial.png", "x");
  Write("result.yaml", "x");
  Write("report.html", "x");
  Write("notes.txt", "x");
  Look();
  const FolderFiles files = Look();
  EXPECT_THAT(files.images, IsEmpty());
  EXPECT_THAT(files.clouds, IsEmpty());
  EXPECT_EQ(files.unsettled, 1U);
}

TEST_F(FolderWatchTest, FoldersWithinItAreWatchedToo) {
  Write("images/b.PNG", "x");
  Write("scans/b.pcd", "x");
  Write("scans/deeper/c.pcd", "x");
  Look();
  const FolderFiles files = Look();
  EXPECT_THAT(Names(files.images), ElementsAre("b.PNG"));
  EXPECT_THAT(Names(files.clouds), ElementsAre("b.pcd"));
}

TEST_F(FolderWatchTest, EveryScanThatIsReadIsWatched) {
  for (const char* name : {"a.las", "b.LAS", "c.xyz", "d.pts", "e.npy", "f.bin"}) Write(name, "x");
  Look();
  EXPECT_THAT(Names(Look().clouds),
              ElementsAre("a.las", "b.LAS", "c.xyz", "d.pts", "e.npy", "f.bin"));
}

TEST_F(FolderWatchTest, PatternsChooseAmongSeveralSensors) {
  FolderWatch left(folder_.path(), "left_*.png", "*.txt");
  Write("left_1.png", "x");
  Write("right_1.png", "x");
  Write("scan.txt", "x");
  Write("scan.pcd", "x");
  ASSERT_TRUE(left.Look());
  const Expected<FolderFiles> files = left.Look();
  ASSERT_TRUE(files);
  EXPECT_THAT(Names(files->images), ElementsAre("left_1.png"));
  EXPECT_THAT(Names(files->clouds), ElementsAre("scan.txt"));
}

TEST_F(FolderWatchTest, AFolderWithinItThatCannotBeReadIsNamedOnce) {
  Write("scans/a.pcd", "x");
  Write("images/a.png", "x");
  std::filesystem::permissions(folder_.path() / "scans", std::filesystem::perms::none);
  std::error_code denied;
  std::filesystem::directory_iterator(folder_.path() / "scans", denied);
  if (!denied) GTEST_SKIP() << "this user may read every folder";
  const FolderFiles first = Look();
  ASSERT_EQ(first.warnings.size(), 1U);
  EXPECT_THAT(first.warnings[0], testing::HasSubstr("scans"));
  const FolderFiles second = Look();
  EXPECT_THAT(second.warnings, IsEmpty());
  EXPECT_THAT(Names(second.images), ElementsAre("a.png"));
  std::filesystem::permissions(folder_.path() / "scans", std::filesystem::perms::owner_all);
  Look();
  EXPECT_THAT(Names(Look().clouds), ElementsAre("a.pcd"));
}

TEST_F(FolderWatchTest, AFolderThatIsNotThereIsAnError) {
  FolderWatch nowhere(folder_.path() / "nowhere");
  const Expected<FolderFiles> files = nowhere.Look();
  ASSERT_FALSE(files);
  EXPECT_EQ(files.error().code, ErrorCode::kIo);
}

TEST_F(FolderWatchTest, KnowsWhichOutputsItWouldTake) {
  Write("a.png", "a photo");
  Write("scans/b.pcd", "a scan");
  Write("scans/deeper/c.pcd", "not watched");
  Look();
  const std::filesystem::path at = folder_.path();
  EXPECT_TRUE(watch_.WouldTake(at / "a.png"));
  EXPECT_TRUE(watch_.WouldTake(at / "new.png"));
  EXPECT_TRUE(watch_.WouldTake(at / "scans" / "." / "new.pcd"));
  EXPECT_FALSE(watch_.WouldTake(at / "scans/deeper/new.pcd"));
  EXPECT_FALSE(watch_.WouldTake(at / "result.yaml"));
  EXPECT_FALSE(watch_.WouldTake(at / "nowhere/new.png"));
  const test::ScratchFolder elsewhere;
  EXPECT_FALSE(watch_.WouldTake(elsewhere.path() / "new.png"));
  std::filesystem::create_hard_link(at / "a.png", elsewhere.path() / "linked");
  EXPECT_TRUE(watch_.WouldTake(elsewhere.path() / "linked"));
}

}  // namespace
}  // namespace sextant
