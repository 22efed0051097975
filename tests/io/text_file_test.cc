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
