// SPDX-License-Identifier: Apache-2.0
#include "io/text/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "support/scratch_folder.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;
using test::ScratchFolder;
using testing::HasSubstr;

std::size_t FilesIn(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(TextFile, WritesWhatIsReadAgain) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "a.txt";
  const std::string bytes("x\0\xff\r\n", 5);
  for (const std::string& text : {bytes, std::string(), std::string(100'000, 'y')}) {
    ASSERT_TRUE(WriteFileAtomically(path, text));
    EXPECT_EQ(*ReadTextFile(path), text);
  }
  EXPECT_EQ(FilesIn(folder.path()), 1U);
}

TEST(TextFile, KeepsPermissionsAndFollowsLinks) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "a.txt";
  const fs::path link = folder.path() / "link";
  ASSERT_TRUE(WriteFileAtomically(path, "old"));
  fs::permissions(path, fs::perms{0640});
  fs::create_symlink("a.txt", link);
  ASSERT_TRUE(WriteFileAtomically(link, "new"));
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(*ReadTextFile(path), "new");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms{0640});
}

TEST(TextFile, LeavesNoFileIfItCannotWrite) {
  const ScratchFolder folder;
  fs::create_directory(folder.path() / "taken");
  const Expected<void> on_folder = WriteFileAtomically(folder.path() / "taken", "x");
  ASSERT_FALSE(on_folder);
  EXPECT_EQ(on_folder.error().code, ErrorCode::kIo);
  EXPECT_THAT(on_folder.error().message, HasSubstr("it is a folder"));
  const Expected<void> nowhere = WriteFileAtomically(folder.path() / "absent" / "a.txt", "x");
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().message, HasSubstr("absent/a.txt': No such file or directory"));
  EXPECT_EQ(FilesIn(folder.path()), 1U);
}

TEST(TextFile, WritesToADeviceWithoutReplacingIt) {
  ASSERT_TRUE(WriteFileAtomically("/dev/null", "x"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  const Expected<void> full = WriteFileAtomically("/dev/full", "x");
  ASSERT_FALSE(full);
  EXPECT_THAT(full.error().message, HasSubstr("No space left on device"));
}

TEST(TextFile, RefusesWhatIsNotAFile) {
  const ScratchFolder folder;
  ASSERT_EQ(mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  const std::pair<fs::path, const char*> cases[] = {
      {folder.path(), "it is a folder, expected a file"},
      {folder.path() / "pipe", "it is not a regular file"},
      {"/dev/zero", "it is not a regular file"},
      {folder.path() / "absent", "No such file or directory"},
      {folder.path() / std::string(300, 'n'), "File name too long"},
      {"", "No such file or directory"},
  };
  for (const auto& [path, reason] : cases) {
    const Expected<std::string> text = ReadTextFile(path);
    ASSERT_FALSE(text) << path;
    EXPECT_EQ(text.error().code, ErrorCode::kIo);
    EXPECT_THAT(text.error().message, HasSubstr(reason));
  }
}

TEST(TextFile, RefusesAFileBeyondTheBoundWithoutReadingIt) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "sparse";
  std::ofstream(path).put('x');
  fs::resize_file(path, std::uintmax_t{1} << 40);
  const Expected<std::string> text = ReadTextFile(path);
  ASSERT_FALSE(text);
  EXPECT_THAT(text.error().message, HasSubstr("1099511627776 bytes"));
}

}  // namespace
}  // namespace sextant
