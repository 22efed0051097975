// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "base/error.h"

namespace sextant {

/// Refuses the small text that Git leaves in place of a large file whose content was not fetched
/// (Git LFS pointer). Error: kParse, with the command that fetches it; it names no file.
Expected<void> RefuseGitLfsPointer(std::string_view bytes);

}  // namespace sextant
