// SPDX-License-Identifier: Apache-2.0
#include "cli/run_program.h"

#include <exception>
#include <new>

#include "base/call_files.h"
#include "cli/output.h"
#include "io/output/output_target.h"
#include "io/output/standard_output.h"
#include "io/output/temporary.h"
#include "io/text/number_text.h"

namespace sextant::cli {
namespace {

Expected<void> CheckOutput(const OutputArgument& output) {
  if (output.writes == Writes::kCheckedByCommand || output.writes == Writes::kFolder) return {};
  if (output.writes == Writes::kFileOrStandardOutput && output.path == "-") return {};
  const Expected<void> ok = ClaimOutput(output.path);
  if (ok) return {};
  return MakeError(ok.error().code, output.option + ": " + ok.error().message);
}

int RunCommand(const ParsedLine& line) {
  const CallFiles files(line.overwrites);
  for (const OutputArgument& output : line.outputs) {
    const Expected<void> ok = CheckOutput(output);
    if (!ok) return Refuse(line.command.c_str(), ok.error());
  }
  return line.run();
}

int RunWithoutExceptions(const std::string& name, const ParsedLine& line) {
  try {
    return RunCommand(line);
  } catch (const std::bad_alloc&) {
    PrintError("{} {}: there is not enough memory for this input\n", name, line.command);
  } catch (const std::exception& error) {
    PrintError("{} {}: this is an error in sextant: {}; please report it with the command\n", name,
               line.command, Printable(error.what(), 300));
  }
  return kFailed;
}

}  // namespace

void PrepareProcess() {
  PrepareStandardStreams();
  RemoveTemporariesOnSignals();
}

int RunLine(const Program& program, const ParsedLine& line) {
  PrintText(line.out);
  PrintErrorText(line.err);
  int exit_code = line.exit_code;
  if (line.run) exit_code = RunWithoutExceptions(program.name, line);
  const Expected<void> finished = FinishOutput();
  if (finished) return exit_code;
  PrintError("{}: {}\n", program.name, finished.error().message);
  // Whatever the answer was, as "cannot tell" of check, it is lost.
  const bool is_failure = exit_code == kWrongUse || exit_code == kFailed;
  return is_failure ? exit_code : kNotWritten;
}

int RunProgram(const Program& program, int argc, const char* const* argv) {
  return RunLine(program, ParseLine(program, argc, argv));
}

}  // namespace sextant::cli
