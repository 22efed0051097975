// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command.h"
#include "cli/parse.h"

namespace sextant::cli {

/// To be called first in main: standard streams (PrepareStandardStreams) and signals
/// (RemoveTemporariesOnSignals).
void PrepareProcess();

/// Prints the texts of the line and runs its command, after its outputs were checked. No exception
/// leaves it, and what standard output could not take is an error. Returns the exit code.
int RunLine(const Program& program, const ParsedLine& line);

/// Parses the arguments and runs the line.
int RunProgram(const Program& program, int argc, const char* const* argv);

}  // namespace sextant::cli
