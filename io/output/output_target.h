// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/stat.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/call_files.h"
#include "base/descriptor.h"
#include "base/error.h"

namespace sextant {

/// Whether an output may replace a file that sextant did not write; see FileOrigin.
enum class Replace {
  kOwnFiles,  ///< Only if the call has --overwrite.
  kAnyFile,   ///< The caller has recognised the file.
};

/// The place of an output: a name in an open folder, so that nobody can exchange the folder later.
struct OutputTarget {
  std::filesystem::path path{};  ///< As given.
  Descriptor folder{};
  std::string name{};
  std::optional<struct stat> existing{};  ///< The regular file that will be replaced.
  bool is_stream = false;                 ///< A device or pipe, which is written directly.
  FileId id{};
};

/// The target of a path. Refused: a folder; a link, unless it leads to a device or pipe, as
/// /dev/stdout; a file that nobody may write. Errors: kInvalidOption; kUnwritable.
Expected<OutputTarget> FindTarget(const std::filesystem::path& path);

/// Refuses a file that sextant did not write, if the call demands it. Error: kInvalidOption.
Expected<void> CheckReplaceable(const OutputTarget& target, Replace replace);

/// Whether the file exists, was not changed since sextant wrote it, and has the text among its
/// first 4096 bytes: for generated pages, which state what wrote them, also in copies.
bool IsPageOf(const std::filesystem::path& path, std::string_view text);

/// To be called before long work for an output that is written after it: checks that it is a
/// possible target, no input and no other output of the call, and that it may be replaced.
/// Errors: kInvalidOption; kUnwritable.
Expected<void> ClaimOutput(const std::filesystem::path& path, OutputUse use = {});

}  // namespace sextant
