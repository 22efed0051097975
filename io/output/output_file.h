// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"
#include "io/output/output_target.h"
#include "io/output/temporary.h"

namespace sextant {

/// A file that appears whole or not at all: a temporary file of an unpredictable name beside the
/// target is written, flushed to the disk and renamed by Commit(). Without Commit() nothing
/// remains, and an existing file is unchanged. A link at the target is never followed, and the
/// permissions of a file that is replaced are kept. Devices and pipes are written directly.
///
/// Errors: kInvalidOption if the call may not write the target (FindTarget, CallFiles,
/// CheckReplaceable); kUnwritable, with the system's reason.
class OutputFile {
 public:
  static Expected<OutputFile> Open(const std::filesystem::path& path,
                                   Replace replace = Replace::kOwnFiles, OutputUse use = {});

  Expected<void> Append(std::string_view bytes);
  /// Overwrites bytes that were appended. Not for devices and pipes.
  Expected<void> WriteAt(std::uint64_t offset, std::string_view bytes);
  Expected<void> Commit();

  /// The path of the temporary file, for another program that writes it; empty for devices and
  /// pipes.
  std::filesystem::path temporary() const;

 private:
  explicit OutputFile(OutputTarget target) : target_(std::move(target)) {}
  Expected<void> OpenTemporary();

  OutputTarget target_;
  std::optional<Temporary> temporary_;  ///< None for devices and pipes. After its folder.
  Descriptor file_;
};

/// Writes the whole file or nothing, as OutputFile does. Errors: those of OutputFile.
Expected<void> WriteFileAtomically(const std::filesystem::path& path, std::string_view bytes,
                                   Replace replace = Replace::kOwnFiles, OutputUse use = {});

}  // namespace sextant
