// SPDX-License-Identifier: Apache-2.0
#include "base/spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "base/spec_text.h"

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

TEST(Spec, TextInQuotesIsAnOptionOfItsOwn) {
  const std::string text = "ransac(command(\"python3 'my solver.py' a,b=c(\",timeout_s=2),seed=7)";
  const Expected<SpecNode> spec = ParseSpec(text);
  ASSERT_TRUE(spec) << spec.error().message;
  const SpecNode& command = spec->inner.at(0);
  EXPECT_EQ(command.options.at(0),
            std::pair(std::string(kSpecText), std::string("python3 'my solver.py' a,b=c(")));
  EXPECT_EQ(FormatSpec(*spec), text);
  EXPECT_EQ(FormatSpec(ParseSpec("a(b=\"c d\")").value()), "a(b=\"c d\")");
  EXPECT_EQ(FormatSpec(ParseSpec("a(b=\"c\")").value()), "a(b=c)");
  for (const std::string& bad :
       {std::string("a(\"b)"), std::string("a(\"\")"), "a(\"" + std::string(1001, 'b') + "\")",
        std::string("a(\"b\nc\")")}) {
    EXPECT_FALSE(ParseSpec(bad)) << bad.substr(0, 20);
  }
}

}  // namespace
}  // namespace sextant
