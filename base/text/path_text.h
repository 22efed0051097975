// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "base/text/printable.h"

namespace sextant {

/// A path as messages show it: Printable, with at most 300 bytes.
inline std::string PathText(const std::filesystem::path& path) {
  return Printable(path.string(), 300);
}

}  // namespace sextant
