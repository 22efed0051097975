// SPDX-License-Identifier: Apache-2.0
#include "calibrate/capture/folder_watch.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/text/lower_case.h"
#include "base/text/path_text.h"
#include "calibrate/session/file_pairs.h"
#include "io/clouds/cloud_file.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

bool IsImageName(const fs::path& path) {
  static constexpr std::array<std::string_view, 9> kExtensions = {
      ".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".pgm", ".ppm", ".webp"};
  return std::ranges::find(kExtensions, LowerCase(path.extension().string())) != kExtensions.end();
}

}  // namespace

FolderWatch::FolderWatch(fs::path folder, std::string image_pattern, std::string cloud_pattern)
    : folder_(std::move(folder)),
      image_pattern_(std::move(image_pattern)),
      cloud_pattern_(std::move(cloud_pattern)) {}

bool FolderWatch::IsImage(const fs::path& path) const {
  if (!image_pattern_.empty()) return MatchesPattern(path.filename().string(), image_pattern_);
  return IsImageName(path);
}

bool FolderWatch::IsCloud(const fs::path& path) const {
  if (!cloud_pattern_.empty()) return MatchesPattern(path.filename().string(), cloud_pattern_);
  return IsCloudName(path);
}

std::error_code FolderWatch::AddFiles(const fs::path& folder, State& found,
                                      std::vector<fs::path>& folders) const {
  std::error_code error;
  fs::directory_iterator it(folder, error);
  for (const fs::directory_iterator end; !error && it != end; it.increment(error)) {
    if (it->path().filename().string().starts_with('.')) continue;
    // A file may disappear at any time; it is then no file of this look.
    std::error_code file_error;
    if (it->is_directory(file_error)) {
      folders.push_back(it->path());
      continue;
    }
    if (!it->is_regular_file(file_error) || (!IsImage(it->path()) && !IsCloud(it->path())))
      continue;
    WatchedFile file{.path = it->path(), .bytes = it->file_size(file_error)};
    if (file_error) continue;
    file.changed = it->last_write_time(file_error);
    if (!file_error) found.emplace(file.path, file);
  }
  return error;
}

Expected<FolderFiles> FolderWatch::Look() {
  State found;
  FolderFiles files;
  std::vector<fs::path> folders;
  if (const std::error_code error = AddFiles(folder_, found, folders)) {
    return MakeError(ErrorCode::kIo, fmt::format("cannot read the folder '{}': {}",
                                                 PathText(folder_), error.message()));
  }
  for (const fs::path& folder : folders) {
    std::vector<fs::path> deeper;  // Not watched.
    const std::error_code error = AddFiles(folder, found, deeper);
    // It may disappear, too.
    if (!error || error == std::errc::no_such_file_or_directory) continue;
    if (!unreadable_.insert(folder).second) continue;
    files.warnings.push_back(fmt::format(
        "cannot read the folder '{}': {}; what is in it is missing until it can be read",
        PathText(folder), error.message()));
  }
  for (const auto& [path, file] : found) {
    const auto before = last_.find(path);
    if (file.bytes == 0 || before == last_.end() || before->second != file) {
      ++files.unsettled;
    } else {
      (IsImage(path) ? files.images : files.clouds).push_back(file);
    }
  }
  last_ = std::move(found);
  return files;
}

bool FolderWatch::IsWatched(const fs::path& folder) const {
  std::error_code error;
  if (fs::equivalent(folder, folder_, error)) return true;
  fs::directory_iterator it(folder_, error);
  for (const fs::directory_iterator end; !error && it != end; it.increment(error)) {
    std::error_code file_error;
    if (it->is_directory(file_error) && fs::equivalent(folder, it->path(), file_error)) return true;
  }
  return false;
}

bool FolderWatch::WouldTake(const fs::path& path) const {
  const auto is_it = [&path](const auto& file) {
    std::error_code error;
    return fs::equivalent(file.first, path, error);
  };
  if (std::ranges::any_of(last_, is_it)) return true;
  if (path.filename().string().starts_with('.') || (!IsImage(path) && !IsCloud(path))) return false;
  return IsWatched(path.has_parent_path() ? path.parent_path() : fs::path("."));
}

}  // namespace sextant
