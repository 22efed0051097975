// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

/// An image and a scan of one moment, as files.
struct FilePair {
  std::string name{};  ///< The distinguishing part of both names: "7" of pose7.png and pose7.pcd.
  std::filesystem::path image{};
  std::filesystem::path cloud{};
};

/// The files that match a path with one or more `*` in its parts, in natural order (9 before 10). A
/// path without `*`, or one that exists literally, gives itself. Time per file of a folder is at
/// most the product of the lengths of its name and of the pattern, whatever the stars.
/// Errors: kIo for a folder that cannot be read; kMissingData where no file matches;
/// kInvalidOption where more than 100,000 do, or that many folders on the way.
Expected<std::vector<std::filesystem::path>> ExpandPattern(const std::filesystem::path& pattern);

/// Whether a file name matches a pattern in which each `*` stands for any text.
bool MatchesPattern(std::string_view name, std::string_view pattern);

struct FilePairs {
  std::vector<FilePair> pairs{};                         ///< In natural order of the names.
  std::vector<std::filesystem::path> without_partner{};  ///< Images and clouds.
};

/// Pairs images with clouds by the distinguishing part of the file name, which is the name without
/// the beginning and the end that all images (all clouds) share. Numbers in it are compared by
/// value (cam_007.png and scan_7.pcd). Where several files have the same name, as in moment_1/a.png
/// and moment_2/a.png, the folders distinguish them. A single image and a single cloud are always a
/// pair.
FilePairs PairFiles(const std::vector<std::filesystem::path>& images,
                    const std::vector<std::filesystem::path>& clouds);

/// What was recorded together, by the distinguishing part of its names.
struct FileMoment {
  std::string name{};
  std::vector<std::filesystem::path> files{};  ///< One for each list; empty where it lacks it.
};

/// As PairFiles for any number of lists, in natural order of the names; a moment may lack some of
/// the files. Lists of at most one file each are one moment. Of several files of a list with the
/// same distinguishing part, the last one counts.
std::vector<FileMoment> GroupFiles(const std::vector<std::vector<std::filesystem::path>>& lists);

}  // namespace sextant
