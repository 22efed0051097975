// SPDX-License-Identifier: Apache-2.0
#include "cli/given_options.h"

#include <fmt/core.h>

#include <algorithm>

namespace sextant::cli {

bool IsGiven(const GivenOptions& given, std::string_view name) {
  return std::find(given.begin(), given.end(), name) != given.end();
}

Expected<void> RefuseGiven(const GivenOptions& given, std::initializer_list<const char*> names,
                           std::string_view why) {
  for (const char* name : names) {
    if (!IsGiven(given, name)) continue;
    return MakeError(ErrorCode::kInvalidOption, fmt::format("{} {}; leave it out", name, why));
  }
  return {};
}

}  // namespace sextant::cli
