// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <regex>
#include <string>

#include "support/run_program.h"

namespace sextant::test {

/// Runs the program that was built with the tests.
inline ProgramRun RunSextant(const std::string& arguments) {
  return RunProgram(SEXTANT_BINARY, arguments);
}

/// The text on one line, however it is broken.
inline std::string Unbroken(const std::string& text) {
  return std::regex_replace(text, std::regex("\\s+"), " ");
}

/// It ended with that exit code and stated the reason.
inline void ExpectRefused(const ProgramRun& run, const std::string& reason, int exit_code = 2) {
  EXPECT_EQ(run.exit_code, exit_code) << run.out << run.err;
  EXPECT_THAT(run.err, testing::HasSubstr(reason));
}

}  // namespace sextant::test
