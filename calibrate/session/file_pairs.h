// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

namespace sextant {

/// An image and a scan of one moment, as files.
struct FilePair {
  std::string name{};  ///< What both names have of their own: "7" of pose7.png and pose7.pcd.
  std::filesystem::path image{};
  std::filesystem::path cloud{};
};

/// The files that a name with one or more `*` in its last part stands for, in natural order (9
/// before 10); a name without, or one that is a file as it stands, stands for itself.
/// Errors: kIo for a folder that cannot be read; kMissingData where nothing has such a name.
Expected<std::vector<std::filesystem::path>> ExpandPattern(const std::filesystem::path& pattern);

struct FilePairs {
  std::vector<FilePair> pairs{};                         ///< In natural order of their names.
  std::vector<std::filesystem::path> without_partner{};  ///< Of both kinds.
};

/// Images and clouds that belong together: what is left of their names without the beginning and
/// the end that all images (all clouds) share must be the same, and numbers in it equal in value
/// (cam_007.png and scan_7.pcd). One image and one cloud always do.
FilePairs PairFiles(const std::vector<std::filesystem::path>& images,
                    const std::vector<std::filesystem::path>& clouds);

}  // namespace sextant
