// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "cli/output.h"
#include "cli/parse.h"
#include "cli/program.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {
namespace {

// The arguments, each of which ends with a zero byte, after the program's name.
std::vector<std::string> Split(std::string_view bytes) {
  std::vector<std::string> arguments = {"sextant"};
  while (!bytes.empty()) {
    const std::size_t end = std::min(bytes.find('\0'), bytes.size());
    arguments.emplace_back(bytes.substr(0, end));
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
  }
  return arguments;
}

}  // namespace

// Reads the arguments of the command line into the options of its command, which is not run.
SEXTANT_FUZZ_TARGET(command_line, bytes) {
  static const cli::Program program = cli::SextantProgram();
  const std::vector<std::string> arguments = Split(bytes);
  std::vector<const char*> argv;
  for (const std::string& argument : arguments) argv.push_back(argument.c_str());
  const cli::ParsedLine line = cli::ParseLine(program, static_cast<int>(argv.size()), argv.data());
  if (line.run) return;
  const bool is_help = line.exit_code == cli::kAnswered;
  if (!is_help && line.exit_code != cli::kWrongUse) Fault("an exit code that is not documented");
  if ((is_help ? line.out : line.err).empty()) Fault("neither a command nor a text");
}

}  // namespace sextant::test
