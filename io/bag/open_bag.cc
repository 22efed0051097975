// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "base/text/path_text.h"
#include "io/bag/mapped_file.h"
#include "io/bag/open_bytes.h"
#include "io/bag/rosbag1_records.h"
#include "io/bag/topic_table.h"
#include "io/text/git_lfs.h"
#include "io/text/number_text.h"
#include "io/text/recording_name.h"

namespace sextant {
namespace {

using std::string_view_literals::operator""sv;

// The only recording in a folder, as ROS 2 writes it next to its metadata.yaml.
Expected<std::filesystem::path> RecordingIn(const std::filesystem::path& folder) {
  std::filesystem::path found;
  int count = 0;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    if (!IsRecording(it->path())) continue;
    ++count;
    if (count == 1 || it->path() < found) found = it->path();
  }
  const std::string name = PathText(folder);
  if (error) {
    return MakeError(ErrorCode::kIo, fmt::format("cannot read '{}': {}", name, error.message()));
  }
  if (count == 1) return found;
  if (count == 0) {
    return MakeError(ErrorCode::kIo,
                     fmt::format("the folder '{}' has no .db3, .mcap or .bag", name));
  }
  return MakeError(ErrorCode::kIo,
                   fmt::format("the folder '{}' has {} recordings; name one of them, "
                               "such as '{}'",
                               name, count, PathText(found)));
}

}  // namespace

Expected<std::unique_ptr<Bag>> OpenBag(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    SEXTANT_ASSIGN_OR_RETURN(const std::filesystem::path inside, RecordingIn(path));
    return OpenBag(inside);
  }
  SEXTANT_ASSIGN_OR_RETURN(const std::shared_ptr<const MappedFile> file, MappedFile::Open(path));
  const std::string_view bytes = file->bytes();
  SEXTANT_RETURN_IF_ERROR(AtPlace(RefuseGitLfsPointer(bytes), {.file = path.string()}));
  if (bytes.starts_with("#ROSBAG"sv)) return OpenRosbag1(bytes, path.string(), file);
  if (bytes.starts_with("\x89MCAP"sv)) return OpenMcap(bytes, path.string(), file);
  if (bytes.starts_with("SQLite format 3\0"sv)) return OpenRosbag2Sqlite(path);
  const char* hint = bytes.starts_with("\x28\xb5\x2f\xfd"sv)
                         ? "; it is compressed as a whole: run `unzstd` on it first"
                         : "";
  return MakeError(ErrorCode::kParse,
                   fmt::format("{}: byte 0: expected a recording: .bag of ROS 1, .db3 of ROS 2 or "
                               ".mcap{}",
                               PathText(path), hint));
}

Expected<void> RequireMessages(const std::string& file, const BagCut& cut,
                               const std::vector<BagTopic>& topics) {
  if (CountMessages(topics) > 0) return {};
  return MakeError(
      ErrorCode::kParse,
      fmt::format("{}: byte {}: {}, before its first message: nothing can be recovered", file,
                  cut.byte, cut.reason));
}

std::string DescribeCut(const Bag& bag) {
  if (!bag.cut()) return {};
  return fmt::format("{} (byte {}): the {} messages before it are read", bag.cut()->reason,
                     bag.cut()->byte, CountMessages(bag.topics()));
}

}  // namespace sextant
