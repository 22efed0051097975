// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "base/error.h"

namespace sextant {

/// A file as it was at one moment.
struct WatchedFile {
  std::filesystem::path path{};
  std::uintmax_t bytes = 0;
  std::filesystem::file_time_type changed{};

  bool operator==(const WatchedFile&) const = default;
};

/// The complete files of a folder, in the order of their names.
struct FolderFiles {
  std::vector<WatchedFile> images{};
  std::vector<WatchedFile> clouds{};
  std::size_t unsettled = 0;  ///< Files that are new, empty, or have changed since the last look.
  /// Why a folder within the folder cannot be read: a sentence for each that the looks before did
  /// not name.
  std::vector<std::string> warnings{};
};

/// The photos and scans that a driver writes into a folder, or into folders within it.
class FolderWatch {
 public:
  /// The patterns are those of file names, with `*`. Empty: every image (.png, .jpg, .jpeg, .bmp,
  /// .tif, .tiff, .pgm, .ppm, .webp) and every scan (IsCloudName).
  explicit FolderWatch(std::filesystem::path folder, std::string image_pattern = "",
                       std::string cloud_pattern = "");

  /// A file is complete if the last look found it with the same size and time of change, so that
  /// none is complete at the first look. Hidden files, as writers use them before a rename, do not
  /// count. Errors: kIo for a folder that cannot be read. Time: O(n log n) in the files.
  Expected<FolderFiles> Look();

  /// Whether an output at the path would be one of these files, or replaces one that the last look
  /// found.
  bool WouldTake(const std::filesystem::path& path) const;

 private:
  using State = std::map<std::filesystem::path, WatchedFile>;

  /// Adds the files of a folder; returns why it cannot be read, if so, and its folders.
  std::error_code AddFiles(const std::filesystem::path& folder, State& found,
                           std::vector<std::filesystem::path>& folders) const;
  bool IsWatched(const std::filesystem::path& folder) const;
  bool IsImage(const std::filesystem::path& path) const;
  bool IsCloud(const std::filesystem::path& path) const;

  std::filesystem::path folder_;
  std::string image_pattern_;
  std::string cloud_pattern_;
  State last_;
  std::set<std::filesystem::path> unreadable_{};  ///< Folders that a warning named.
};

}  // namespace sextant
