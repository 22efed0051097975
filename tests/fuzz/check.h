// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "base/error.h"

namespace sextant::test {

/// A reader must read its input or refuse it with a message of one short line; anything else
/// aborts.
template <class T>
void CheckOutcome(const Expected<T>& outcome) {
  if (outcome) return;
  const std::string& message = outcome.error().message;
  if (message.empty() || message.size() > 800 || message.find('\n') != std::string::npos) {
    std::abort();
  }
}

}  // namespace sextant::test
