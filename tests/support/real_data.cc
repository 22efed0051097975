// SPDX-License-Identifier: Apache-2.0
#include "support/real_data.h"

#include <cstdlib>

namespace sextant::test {

std::optional<std::filesystem::path> RealDataFolder() {
  const char* set = std::getenv("SEXTANT_DATA");
  const std::filesystem::path folder =
      set != nullptr ? std::filesystem::path(set)
                     : std::filesystem::path(SEXTANT_SOURCE_DIR) / ".." / "shared" / "data";
  if (!std::filesystem::is_directory(folder)) return std::nullopt;
  return folder;
}

}  // namespace sextant::test
