// SPDX-License-Identifier: Apache-2.0
#include "cli/features.h"

#include <fmt/core.h>

#include "base/version.h"

namespace sextant::cli {

std::string VersionText() {
  return fmt::format(
      "{}\nbuilt with     {}\nbuilt without  {}\nlibraries      {}\ncompiler       {}", Version(),
      SEXTANT_BUILT_WITH, SEXTANT_BUILT_WITHOUT, SEXTANT_LIBRARIES, SEXTANT_COMPILER);
}

}  // namespace sextant::cli
