// SPDX-License-Identifier: Apache-2.0
#include "base/text/file_name.h"

#include <algorithm>

namespace sextant {
namespace {

// Independent of the locale.
bool MayStandInFileName(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
         c == '_' || c == '-';
}

}  // namespace

bool IsFileName(std::string_view name) {
  constexpr std::size_t kMaxBytes = 100;
  return !name.empty() && name.size() <= kMaxBytes && name.front() != '.' && name.front() != '-' &&
         std::all_of(name.begin(), name.end(), MayStandInFileName);
}

}  // namespace sextant
