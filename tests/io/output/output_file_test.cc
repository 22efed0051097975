// SPDX-License-Identifier: Apache-2.0
#include "io/output/output_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <string>
#include <vector>

#include "io/output/remove_file.h"
#include "io/text/text_file.h"
#include "support/file_marks.h"
#include "support/run_program.h"
#include "support/scratch_folder.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;
using test::ReadText;
using test::ScratchFolder;
using test::WriteText;
using testing::HasSubstr;

std::size_t FilesIn(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

void ExpectRefused(const Expected<void>& result, const std::string& reason) {
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidOption);
  EXPECT_THAT(result.error().message, HasSubstr(reason));
}

TEST(OutputFile, WritesWhatIsReadAgain) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "a.txt";
  const std::string bytes("x\0\xff\r\n", 5);
  for (const std::string& text : {bytes, std::string(), std::string(100'000, 'y')}) {
    ASSERT_TRUE(WriteFileAtomically(path, text));
    EXPECT_EQ(*ReadTextFile(path), text);
  }
  EXPECT_EQ(FilesIn(folder.path()), 1U);
}

TEST(OutputFile, ANewFileHasThePermissionsOfTheUmask) {
  const ScratchFolder folder;
  const mode_t before = umask(0027);
  ASSERT_TRUE(WriteFileAtomically(folder.path() / "a", "x"));
  umask(before);
  EXPECT_EQ(fs::status(folder.path() / "a").permissions(), fs::perms{0640});
}

TEST(OutputFile, KeepsThePermissionsOfAFileThatItReplaces) {
  const ScratchFolder folder;
  WriteText(folder.path() / "a", "old");
  fs::permissions(folder.path() / "a", fs::perms{0600});
  ASSERT_TRUE(WriteFileAtomically(folder.path() / "a", "new"));
  EXPECT_EQ(fs::status(folder.path() / "a").permissions(), fs::perms{0600});
}

TEST(OutputFile, FollowsNoLink) {
  const ScratchFolder folder;
  WriteText(folder.path() / "precious", "old");
  fs::create_symlink("precious", folder.path() / "link");
  ExpectRefused(WriteFileAtomically(folder.path() / "link", "new"), "it is a link to 'precious'");
  EXPECT_EQ(ReadText(folder.path() / "precious"), "old");
  fs::create_symlink("absent", folder.path() / "dangling");
  ExpectRefused(WriteFileAtomically(folder.path() / "dangling", "new"), "it is a link to 'absent'");
  EXPECT_FALSE(fs::exists(folder.path() / "absent"));
  fs::create_symlink("loop", folder.path() / "loop");
  ExpectRefused(WriteFileAtomically(folder.path() / "loop", "new"), "it is a link to 'loop'");
}

TEST(OutputFile, ALinkAtTheNameDuringTheWriteIsReplacedNotFollowed) {
  const ScratchFolder folder;
  WriteText(folder.path() / "precious", "old");
  Expected<OutputFile> file = OutputFile::Open(folder.path() / "a");
  ASSERT_TRUE(file);
  fs::create_symlink("precious", folder.path() / "a");
  ASSERT_TRUE(file->Append("new"));
  ASSERT_TRUE(file->Commit());
  EXPECT_EQ(ReadText(folder.path() / "precious"), "old");
  EXPECT_EQ(ReadText(folder.path() / "a"), "new");
  EXPECT_FALSE(fs::is_symlink(folder.path() / "a"));
}

TEST(OutputFile, AnotherNameOfTheFileKeepsTheOldContent) {
  const ScratchFolder folder;
  WriteText(folder.path() / "a", "old");
  fs::create_hard_link(folder.path() / "a", folder.path() / "b");
  ASSERT_TRUE(WriteFileAtomically(folder.path() / "a", "new"));
  EXPECT_EQ(ReadText(folder.path() / "b"), "old");
}

TEST(OutputFile, RefusesAReadOnlyFile) {
  const ScratchFolder folder;
  WriteText(folder.path() / "a", "old");
  fs::permissions(folder.path() / "a", fs::perms{0444});
  const Expected<void> result = WriteFileAtomically(folder.path() / "a", "new");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kUnwritable);
  EXPECT_THAT(result.error().message, HasSubstr("it is read-only"));
  EXPECT_EQ(ReadText(folder.path() / "a"), "old");
}

TEST(OutputFile, LeavesNoFileIfItCannotWrite) {
  const ScratchFolder folder;
  fs::create_directory(folder.path() / "taken");
  ExpectRefused(WriteFileAtomically(folder.path() / "taken", "x"), "it is a folder");
  ExpectRefused(WriteFileAtomically(folder.path() / "taken/", "x"), "it names a folder");
  ExpectRefused(WriteFileAtomically("", "x"), "got an empty text");
  const Expected<void> nowhere = WriteFileAtomically(folder.path() / "absent" / "a.txt", "x");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::kUnwritable);
  EXPECT_THAT(nowhere.error().message, HasSubstr("absent/a.txt': No such file or directory"));
  { const Expected<OutputFile> dropped = OutputFile::Open(folder.path() / "dropped"); }
  EXPECT_EQ(FilesIn(folder.path()), 1U);
}

TEST(OutputFile, WritesToADeviceWithoutReplacingIt) {
  ASSERT_TRUE(WriteFileAtomically("/dev/null", "x"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  const Expected<void> full = WriteFileAtomically("/dev/full", "x");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, ErrorCode::kUnwritable);
  EXPECT_THAT(full.error().message, HasSubstr("No space left on device"));
}

// Opening it would wait for a reader that may never come.
TEST(OutputFile, APipeThatNobodyReadsIsRefused) {
  const ScratchFolder folder;
  const fs::path pipe = folder.path() / "report.md";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  ExpectRefused(WriteFileAtomically(pipe, "x"), "a pipe that no process reads");
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST(OutputFile, TheNamesOfTemporariesDiffer) {
  const ScratchFolder folder;
  const Expected<OutputFile> one = OutputFile::Open(folder.path() / "a");
  const Expected<OutputFile> two = OutputFile::Open(folder.path() / "a");
  ASSERT_TRUE(one && two);
  EXPECT_NE(one->temporary(), two->temporary());
  EXPECT_TRUE(IsTemporaryName(one->temporary().filename().string()));
  for (const char* name : {".a.tmp", ".a.0123456789abcdef", "a.0123456789abcdef.sxtmp",
                           ".a.0123456789abcdeg.sxtmp", ".0123456789abcdef.sxtmp"}) {
    EXPECT_FALSE(IsTemporaryName(name)) << name;
  }
}

TEST(OutputFile, OverwritesWhatItAppended) {
  const ScratchFolder folder;
  Expected<OutputFile> file = OutputFile::Open(folder.path() / "a");
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->Append("0123456789"));
  ASSERT_TRUE(file->WriteAt(2, "xy"));
  ASSERT_TRUE(file->Append("!"));
  ASSERT_TRUE(file->Commit());
  EXPECT_EQ(ReadText(folder.path() / "a"), "01xy456789!");
}

TEST(OutputOfACall, IsNoInputByWhateverName) {
  const ScratchFolder folder;
  WriteText(folder.path() / "in", "data");
  fs::create_hard_link(folder.path() / "in", folder.path() / "hard");
  fs::create_directory_symlink(".", folder.path() / "same");
  const CallFiles files(/*may_overwrite=*/true);
  ASSERT_TRUE(ReadTextFile(folder.path() / "in"));
  for (const char* name : {"in", "hard", "same/in", "../"}) {
    const fs::path path = name == std::string("../")
                              ? folder.path() / ".." / folder.path().filename() / "in"
                              : folder.path() / name;
    ExpectRefused(WriteFileAtomically(path, "x"), "it is an input of the same command");
    ExpectRefused(ClaimOutput(path), "it is an input of the same command");
  }
  EXPECT_EQ(ReadText(folder.path() / "in"), "data");
}

TEST(OutputOfACall, IsNoOtherOutputAlsoBeforeItExists) {
  const ScratchFolder folder;
  fs::create_directory_symlink(".", folder.path() / "same");
  const CallFiles files(/*may_overwrite=*/false);
  ASSERT_TRUE(ClaimOutput(folder.path() / "a"));
  ExpectRefused(ClaimOutput(folder.path() / "same" / "a"), "already an output");
  ASSERT_TRUE(WriteFileAtomically(folder.path() / "a", "one"));
  ExpectRefused(WriteFileAtomically(folder.path() / "a", "two"), "already an output");
  EXPECT_EQ(*ReadTextFile(folder.path() / "a"), "one");
}

TEST(OutputOfACall, AClaimedOutputCannotBeRead) {
  const ScratchFolder folder;
  WriteText(folder.path() / "a", "data");
  const CallFiles files(/*may_overwrite=*/true);
  ASSERT_TRUE(ClaimOutput(folder.path() / "a"));
  const Expected<std::string> text = ReadTextFile(folder.path() / "a");
  ASSERT_FALSE(text);
  EXPECT_THAT(text.error().message, HasSubstr("also an output of the same command"));
}

TEST(OutputOfACall, ReplacesOnlyWhatSextantWrote) {
  const ScratchFolder folder;
  if (!test::KeepsMarks(folder.path())) GTEST_SKIP() << "the file system keeps no attributes";
  const fs::path path = folder.path() / "a";
  const auto write = [&](bool may_overwrite) {
    const CallFiles files(may_overwrite);
    return WriteFileAtomically(path, "ours");
  };
  WriteText(path, "foreign");
  ExpectRefused(write(false), "sextant did not write it");
  EXPECT_EQ(ReadText(path), "foreign");
  ASSERT_TRUE(write(true));
  ASSERT_TRUE(write(false)) << "a file of ours";
  WriteText(path, "ours, edited");
  ExpectRefused(write(false), "--overwrite");
  fs::remove(path);
  WriteText(path, "");
  ASSERT_TRUE(write(false)) << "an empty file";
}

TEST(OutputOfACall, RemovesOnlyWhatSextantWrote) {
  const ScratchFolder folder;
  WriteText(folder.path() / "foreign", "x");
  const CallFiles files(/*may_overwrite=*/false);
  ExpectRefused(CheckRemovable(folder.path() / "foreign"), "sextant did not write it");
  ExpectRefused(RemoveFile(folder.path() / "foreign"), "sextant did not write it");
  EXPECT_TRUE(RemoveFile(folder.path() / "absent"));
  EXPECT_TRUE(RemoveFile(folder.path() / "foreign", Replace::kAnyFile));
  EXPECT_EQ(FilesIn(folder.path()), 0U);
}

}  // namespace
}  // namespace sextant
