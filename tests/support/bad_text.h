// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <ostream>
#include <string>

#include "base/error.h"

namespace sextant::test {

/// A text that a reader must reject, with the expected error.
struct BadText {
  const char* name;
  std::string text;
  ErrorCode code;
  const char* message;
};

inline void PrintTo(const BadText& bad, std::ostream* out) { *out << bad.name; }

inline std::string Repeated(const std::string& piece, int times) {
  std::string text;
  for (int i = 0; i < times; ++i) text += piece;
  return text;
}

/// Checks that the error is one short line that names the position.
template <class T>
void ExpectRefused(const Expected<T>& read, const BadText& bad) {
  ASSERT_FALSE(read) << bad.name;
  EXPECT_EQ(ToString(read.error().code), ToString(bad.code)) << read.error().message;
  EXPECT_THAT(read.error().message, testing::HasSubstr(bad.message));
  EXPECT_THAT(read.error().message, testing::Not(testing::HasSubstr("\n")));
  EXPECT_LT(read.error().message.size(), 400U);
}

}  // namespace sextant::test
