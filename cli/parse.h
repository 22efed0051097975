// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "cli/command.h"

namespace sextant::cli {

/// The result of parsing a command line: a command to run, or a text to print (help, version,
/// error) and the exit code to end with.
struct ParsedLine {
  std::function<int()> run{};  ///< Empty: there is only text.
  int exit_code = 0;
  std::string out{};  ///< For standard output.
  std::string err{};  ///< For standard error.
};

/// Reads the arguments into the options of the chosen command. Wrong usage gives kWrongUse.
ParsedLine ParseLine(const Program& program, int argc, const char* const* argv);

/// Parses, prints, and runs the command. Returns the exit code.
int RunProgram(const Program& program, int argc, const char* const* argv);

}  // namespace sextant::cli
