// SPDX-License-Identifier: Apache-2.0
#include "io/output/output_folder.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <optional>
#include <string>

#include "io/output/appended_file.h"
#include "io/output/output_file.h"
#include "support/run_program.h"
#include "support/scratch_folder.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;
using test::ReadText;
using test::ScratchFolder;
using test::WriteText;
using testing::HasSubstr;

TEST(OutputFolder, IsRefusedToASecondUserWithTheFirstOnesNumber) {
  const ScratchFolder scratch;
  const fs::path path = scratch.path() / "new" / "results";
  {
    const Expected<OutputFolder> first = OutputFolder::Open(path);
    ASSERT_TRUE(first);
    for (const Sharing sharing : {Sharing::kAlone, Sharing::kWithOthers}) {
      const Expected<OutputFolder> second = OutputFolder::Open(path, sharing);
      ASSERT_FALSE(second);
      EXPECT_THAT(second.error().message,
                  HasSubstr(fmt::format("is in use by process {}", getpid())));
    }
  }
  EXPECT_TRUE(fs::is_empty(path));
  EXPECT_TRUE(OutputFolder::Open(path));
}

TEST(OutputFolder, IsSharedByThoseThatShareIt) {
  const ScratchFolder scratch;
  std::optional<OutputFolder> kept;
  {
    Expected<OutputFolder> first = OutputFolder::Open(scratch.path(), Sharing::kWithOthers);
    Expected<OutputFolder> second = OutputFolder::Open(scratch.path(), Sharing::kWithOthers);
    ASSERT_TRUE(first && second);
    EXPECT_FALSE(OutputFolder::Open(scratch.path()));
    kept.emplace(std::move(*second));
  }
  EXPECT_FALSE(OutputFolder::Open(scratch.path())) << "one of them is left";
  kept.reset();
  EXPECT_TRUE(OutputFolder::Open(scratch.path()));
  EXPECT_TRUE(fs::is_empty(scratch.path()));
}

TEST(OutputFolder, ASubfolderIsNoLink) {
  const ScratchFolder scratch;
  fs::create_directories(scratch.path() / "elsewhere");
  fs::create_directory_symlink("elsewhere", scratch.path() / "link");
  const Expected<void> made = MakeSubfolder(scratch.path() / "link");
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().message, HasSubstr("it is a link to 'elsewhere'"));
  EXPECT_TRUE(MakeSubfolder(scratch.path() / "new"));
  EXPECT_TRUE(MakeSubfolder(scratch.path() / "new"));
}

TEST(AppendedFile, ASecondWriterIsRefusedWithTheFirstOnesNumber) {
  const ScratchFolder scratch;
  const Expected<AppendedFile> first = AppendedFile::Open(scratch.path() / "rows");
  ASSERT_TRUE(first);
  const Expected<AppendedFile> second = AppendedFile::Open(scratch.path() / "rows");
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr(fmt::format("process {} writes it", getpid())));
}

TEST(OutputFolder, OnlyTheTemporariesOfTheDeadAreRemoved) {
  const ScratchFolder scratch;
  const fs::path dead = scratch.path() / ".scan.pcd.0123456789abcdef.sxtmp";
  const fs::path foreign = scratch.path() / ".mine.tmp";
  WriteText(dead, "half");
  WriteText(foreign, "whole");
  const Expected<OutputFile> alive = OutputFile::Open(scratch.path() / "a");
  ASSERT_TRUE(alive);
  const Expected<OutputFolder> folder = OutputFolder::Open(scratch.path());
  ASSERT_TRUE(folder);
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(foreign));
  EXPECT_TRUE(fs::exists(alive->temporary()));
  EXPECT_TRUE(OutputFolder::IsPassing(alive->temporary().filename().string()));
}

TEST(OutputFolder, OnlyTheTemporariesOfTheDeadAreRemovedFromASubfolder) {
  const ScratchFolder scratch;
  const fs::path sub = scratch.path() / "001";
  ASSERT_TRUE(MakeSubfolder(sub));
  const fs::path dead = sub / ".7.yaml.0123456789abcdef.sxtmp";
  WriteText(dead, "half");
  WriteText(sub / "7.yaml", "whole");
  const Expected<OutputFile> alive = OutputFile::Open(sub / "8.yaml");
  ASSERT_TRUE(alive);
  ASSERT_TRUE(MakeSubfolder(sub));
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(sub / "7.yaml"));
  EXPECT_TRUE(fs::exists(alive->temporary()));
}

TEST(OutputFolder, AFileInItsPlaceIsRefused) {
  const ScratchFolder scratch;
  WriteText(scratch.path() / "taken", "x");
  const Expected<OutputFolder> folder = OutputFolder::Open(scratch.path() / "taken");
  ASSERT_FALSE(folder);
  EXPECT_EQ(folder.error().code, ErrorCode::kUnwritable);
  EXPECT_THAT(folder.error().message, HasSubstr("cannot make the folder"));
}

TEST(OutputFolder, AFileOfTheLocksNameThatIsNoLockIsKept) {
  const ScratchFolder scratch;
  const fs::path lock = scratch.path() / ".sextant.lock";
  WriteText(lock, "notes");
  const Expected<OutputFolder> foreign = OutputFolder::Open(scratch.path());
  ASSERT_FALSE(foreign);
  EXPECT_THAT(foreign.error().message, HasSubstr("it is no lock of sextant"));
  EXPECT_EQ(ReadText(lock), "notes");
  fs::remove(lock);
  WriteText(scratch.path() / "precious", "12");
  fs::create_hard_link(scratch.path() / "precious", lock);
  EXPECT_FALSE(OutputFolder::Open(scratch.path()));
  EXPECT_EQ(ReadText(scratch.path() / "precious"), "12");
}

// A copy by a hard link would lose its rows to a run from the start.
TEST(AppendedFile, OfTwoNamesIsRefused) {
  const ScratchFolder scratch;
  WriteText(scratch.path() / "rows", "old");
  fs::create_hard_link(scratch.path() / "rows", scratch.path() / "copy");
  const Expected<AppendedFile> file = AppendedFile::Open(scratch.path() / "rows");
  ASSERT_FALSE(file);
  EXPECT_THAT(file.error().message, HasSubstr("2 names (hard links)"));
}

TEST(AppendedFile, ContinuesAtItsEnd) {
  const ScratchFolder scratch;
  const fs::path path = scratch.path() / "rows";
  {
    Expected<AppendedFile> file = AppendedFile::Open(path);
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->Append("one"));
    EXPECT_FALSE(AppendedFile::Open(path)) << "it is locked";
  }
  Expected<AppendedFile> file = AppendedFile::Open(path);
  ASSERT_TRUE(file);
  EXPECT_EQ(file->size(), 3U);
  EXPECT_EQ(*file->ReadBeginning(2), "on");
  ASSERT_TRUE(file->Truncate(1));
  ASSERT_TRUE(file->Append("k"));
  ASSERT_TRUE(file->Flush());
  EXPECT_EQ(ReadText(path), "ok");
}

TEST(AppendedFile, FollowsNoLinkAndTakesNoDevice) {
  const ScratchFolder scratch;
  WriteText(scratch.path() / "precious", "old");
  fs::create_symlink("precious", scratch.path() / "rows");
  EXPECT_FALSE(AppendedFile::Open(scratch.path() / "rows"));
  EXPECT_FALSE(AppendedFile::Open("/dev/null"));
  EXPECT_EQ(ReadText(scratch.path() / "precious"), "old");
}

}  // namespace
}  // namespace sextant
