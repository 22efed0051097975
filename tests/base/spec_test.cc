// SPDX-License-Identifier: Apache-2.0
#include "base/spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace sextant {
namespace {

using testing::HasSubstr;

TEST(Spec, AMessageQuotesThePartAroundTheFault) {
  const std::string text = std::string(5000, ' ') + "kabsch(seed=)" + std::string(5000, ' ');
  const Expected<SpecNode> spec = ParseSpec(text);
  ASSERT_FALSE(spec);
  EXPECT_THAT(spec.error().message, HasSubstr("kabsch(seed=)"));
  EXPECT_THAT(spec.error().message, HasSubstr("column 5013: expected a value for 'seed'"));
  EXPECT_LT(spec.error().message.size(), 250U);
}

TEST(Spec, NamesAndValuesHaveABoundedLength) {
  EXPECT_TRUE(ParseSpec(std::string(100, 'a') + "(b=" + std::string(100, '1') + ")"));
  for (const std::string& text : {std::string(101, 'a'), "a(b=" + std::string(101, '1') + ")"}) {
    const Expected<SpecNode> spec = ParseSpec(text);
    ASSERT_FALSE(spec);
    EXPECT_THAT(spec.error().message,
                HasSubstr("expected a name or value of at most 100 characters"));
  }
}

}  // namespace
}  // namespace sextant
