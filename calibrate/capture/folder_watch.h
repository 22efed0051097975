// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
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

 private:
  using State = std::map<std::filesystem::path, WatchedFile>;

  Expected<void> AddFolder(const std::filesystem::path& folder, bool with_folders,
                           State& found) const;
  bool IsImage(const std::filesystem::path& path) const;
  bool IsCloud(const std::filesystem::path& path) const;

  std::filesystem::path folder_;
  std::string image_pattern_;
  std::string cloud_pattern_;
  State last_;
};

}  // namespace sextant
