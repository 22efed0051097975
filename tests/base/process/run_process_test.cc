// SPDX-License-Identifier: Apache-2.0
#include "base/process/run_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "support/hostile_text.h"

namespace sextant {
namespace {

using testing::HasSubstr;

TEST(RunProcess, ArgumentsArriveAsTheyAre) {
  for (const std::string& text : test::HostileTexts()) {
    // A zero byte ends an argument for the system.
    if (text.find('\0') != std::string::npos) continue;
    const Expected<ProcessEnd> end = RunProcess({"printf", "%s|", text});
    ASSERT_TRUE(end) << end.error().message;
    EXPECT_EQ(end->out, text + "|");
    EXPECT_EQ(end->exit_code, 0);
  }
}

TEST(RunProcess, PassesInputOfAnySize) {
  for (const std::size_t size : {0UL, 1UL, 100'000UL, 10'000'000UL}) {
    const std::string text(size, 'x');
    const Expected<ProcessEnd> end = RunProcess({"cat"}, {.standard_input = text});
    ASSERT_TRUE(end) << end.error().message;
    EXPECT_TRUE(end->out == text) << size;
  }
}

// A program that does not read its input is no broken pipe.
TEST(RunProcess, InputMayStayUnread) {
  const Expected<ProcessEnd> end =
      RunProcess({"true"}, {.standard_input = std::string(1'000'000, 'x')});
  ASSERT_TRUE(end) << end.error().message;
  EXPECT_EQ(end->exit_code, 0);
}

TEST(RunProcess, GivesExitCodeAndMessages) {
  const Expected<ProcessEnd> failed = RunProcess({"ls", "/no/such/folder"});
  ASSERT_TRUE(failed);
  EXPECT_NE(failed->exit_code, 0);
  EXPECT_EQ(failed->out, "");
  EXPECT_THAT(failed->err, HasSubstr("/no/such/folder"));
}

TEST(RunProcess, AProgramThatIsNotInstalledIsMissing) {
  const Expected<ProcessEnd> end = RunProcess({"no-such-program-anywhere"});
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().code, ErrorCode::kMissingData);
  EXPECT_THAT(end.error().message, HasSubstr("no-such-program-anywhere"));
}

TEST(RunProcess, StopsAProgramThatDoesNotEnd) {
  const Expected<ProcessEnd> end =
      RunProcess({"sleep", "1000"}, {.timeout = std::chrono::milliseconds(50)});
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().code, ErrorCode::kIo);
  EXPECT_THAT(end.error().message, HasSubstr("stopped after 0.05 s"));
}

TEST(RunProcess, LimitsTheOutput) {
  const Expected<ProcessEnd> end =
      RunProcess({"cat"}, {.standard_input = std::string(1000, 'x'), .max_bytes = 999});
  ASSERT_FALSE(end);
  EXPECT_THAT(end.error().message, HasSubstr("more than 999 bytes"));
}

TEST(RunProcess, StopsAProgramThatWritesWithoutEnd) {
  const Expected<ProcessEnd> end =
      RunProcess({"yes"}, {.timeout = std::chrono::seconds(5), .max_bytes = 1 << 20});
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().code, ErrorCode::kIo);
  EXPECT_THAT(end.error().message, HasSubstr("yes: it wrote more than 1048576 bytes"));
}

}  // namespace
}  // namespace sextant
