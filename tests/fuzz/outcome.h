// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>

#include "base/error.h"

namespace sextant::test {

/// The code under test broke a promise.
[[noreturn]] inline void Fault(const std::string& what) { throw std::logic_error(what); }

/// Whether the text can be shown on a terminal: no control characters, not even a line break.
inline bool IsOneLine(std::string_view text) {
  return std::none_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f;
  });
}

/// A reader must read its input or refuse it with a short message of one line.
template <class T>
void CheckOutcome(const Expected<T>& outcome) {
  constexpr std::size_t kMaxMessage = 800;
  if (outcome) return;
  const std::string& message = outcome.error().message;
  if (message.empty()) Fault("an error without a message");
  if (message.size() > kMaxMessage) {
    Fault("a message of " + std::to_string(message.size()) + " bytes: " + message.substr(0, 200));
  }
  if (!IsOneLine(message)) Fault("control characters in a message: " + message);
}

/// The same; and what was read can be written, reads back, and is then written as the same text.
template <class T, class Parse, class Format>
void CheckRoundTrip(const Expected<T>& outcome, Parse parse, Format format) {
  CheckOutcome(outcome);
  if (!outcome) return;
  const std::string text = format(*outcome);
  const Expected<T> again = parse(std::string_view{text}, "written");
  if (!again) Fault("what was written is refused: " + again.error().message);
  if (format(*again) != text) Fault("what was written reads back as something else");
}

}  // namespace sextant::test
