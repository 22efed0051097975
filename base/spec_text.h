// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sextant {

/// In specs (base/spec.h) a value, or an argument without a key, may be a text in double quotes: 1
/// to 1000 printable characters but these quotes. Without a key it is the option of this name.
inline constexpr const char* kSpecText = "text";

}  // namespace sextant
