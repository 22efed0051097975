// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/command.h"

namespace sextant::cli {

/// What the chosen command is to write.
struct OutputArgument {
  std::string option{};  ///< Its name, as "--json".
  std::string path{};
  Writes writes = Writes::kNothing;
};

/// The result of parsing a command line: a command to run, or a text to print (help, version,
/// error) and the exit code to end with.
struct ParsedLine {
  std::function<int()> run{};  ///< Empty: there is only text.
  std::string command{};       ///< Its name, as "simulate pairs".
  std::vector<OutputArgument> outputs{};
  bool overwrites = false;  ///< --overwrite.
  int exit_code = 0;
  std::string out{};  ///< For standard output.
  std::string err{};  ///< For standard error.
};

/// Reads the arguments into the options of the chosen command. Wrong usage gives kWrongUse.
ParsedLine ParseLine(const Program& program, int argc, const char* const* argv);

}  // namespace sextant::cli
