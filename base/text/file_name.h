// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace sextant {

/// What IsFileName requires, for messages.
inline constexpr std::string_view kFileNameRule =
    "letters (a to z), digits, '.', '_' and '-', with neither '.' nor '-' first, at most 100";

/// Whether a name from a file may become the name of a file or folder: it stays in its folder on
/// every system, is not hidden, and no program takes it for an option.
bool IsFileName(std::string_view name);

}  // namespace sextant
