// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "base/error.h"
#include "io/output/output_target.h"

namespace sextant {

/// Refuses what RemoveFile would refuse, and changes nothing.
Expected<void> CheckRemovable(const std::filesystem::path& path,
                              Replace replace = Replace::kOwnFiles);

/// Removes a file under the rules by which OutputFile replaces one. No error if there is none.
/// Errors: kInvalidOption; kUnwritable.
Expected<void> RemoveFile(const std::filesystem::path& path, Replace replace = Replace::kOwnFiles);

/// Removes a file that sextant wrote and nobody changed, and no other, whatever may be replaced.
/// Whether it did so.
bool RemoveOwnFile(const std::filesystem::path& path);

}  // namespace sextant
