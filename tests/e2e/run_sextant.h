// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "support/run_program.h"

namespace sextant::test {

/// Runs the program that was built with the tests.
inline ProgramRun RunSextant(const std::string& arguments) {
  return RunProgram(SEXTANT_BINARY, arguments);
}

}  // namespace sextant::test
