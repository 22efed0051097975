// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/commands.h"
#include "eval/diagnostics/pair_diagnostics.h"
#include "io/problems/problem_yaml.h"
#include "io/results/results_json.h"

namespace sextant::cli {

/// The input of `solve` and `compare`, ready for the solvers.
struct LoadedInput {
  ProblemFile file;
  PairDiagnostics judgement;       ///< Of the pairs as the file gives them.
  std::vector<std::string> notes;  ///< What was put right while reading.
  ResultInput summary;
};

/// Reads, adds the camera and the boards that the user names, judges, and reorders where asked.
Expected<LoadedInput> Load(const InputOptions& options);

/// "sextant <command>: <message>" on standard error; returns `exit_code`.
int Refuse(const char* command, const Error& error, int exit_code = kWrongUse);

/// Prints the text, or writes the results where --json says so; text and JSON never share standard
/// output. Returns the exit code: `exit_code`, or kWrongUse where the file cannot be written.
int Deliver(const char* command, const std::string& json_path, const std::string& text,
            const std::string& json, int exit_code);

}  // namespace sextant::cli
