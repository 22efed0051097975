// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"

// The command tables as plain texts, from which manual page and completions are made.
namespace sextant::cli {

struct OutlinedArgument {
  std::string name;   ///< "--json", or "FILE" of a positional argument.
  std::string value;  ///< "NUMBER", "TEXT" or "FILE"; empty for a flag.
  std::string help;
  std::vector<std::string> choices{};
  bool required = false;
  bool repeats = false;  ///< Takes several values.
};

struct OutlinedCommand {
  std::string name;  ///< Without the program's: "list solvers".
  std::string group{};
  std::string summary{};
  std::string footer{};
  std::vector<OutlinedArgument> positionals{};
  std::vector<OutlinedArgument> options{};  ///< With --help, and --overwrite where it applies.
  std::vector<std::string> subcommands{};
};

/// Every command of the program, each followed by its subcommands.
std::vector<OutlinedCommand> Outline(const Program& program);

/// The text up to its first full stop, colon or semicolon, on one line: what fits a menu.
std::string FirstSentence(const std::string& text);

}  // namespace sextant::cli
