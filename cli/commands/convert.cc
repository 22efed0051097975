// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/problem_input.h"
#include "io/output/output_file.h"
#include "io/problems/points_file.h"
#include "io/problems/read_problem.h"

namespace sextant::cli {
namespace {

struct ConvertOptions {
  std::string from{};
  std::string to{};
};

void Declare(ConvertOptions& options, Arguments& arguments) {
  arguments.Add("FROM", options.from, kCorrespondencesHelp, {.required = true});
  arguments.Add("TO", options.to,
                "Written by its extension: .yaml (everything) or .txt (points.txt)",
                {.required = true, .writes = Writes::kFile});
}

Expected<std::string> FormatAs(const std::string& extension, const ProblemFile& file) {
  const CalibrationProblem& problem = file.problem;
  if (extension == ".yaml" || extension == ".yml") return FormatProblemYaml(file);
  if (extension == ".txt") {
    if (!problem.pairs_3d3d.empty()) return FormatPoints(problem.pairs_3d3d);
    return MakeError(ErrorCode::kMissingData, "points.txt holds 3D-3D pairs, and there are none");
  }
  return MakeError(ErrorCode::kInvalidOption,
                   "expected an output that ends in .yaml or .txt, got '" + extension + "'");
}

int Run(const ConvertOptions& options) {
  const Expected<DetectedProblem> read = ReadProblem(options.from);
  if (!read) return Refuse("convert", read.error());
  const Expected<std::string> text =
      FormatAs(std::filesystem::path(options.to).extension().string(), *read);
  if (!text) return Refuse("convert", text.error());
  if (const Expected<void> ok = WriteFileAtomically(options.to, *text); !ok) {
    return Refuse("convert", ok.error());
  }
  return kAnswered;
}

}  // namespace

Command ConvertCommand() {
  constexpr const char* kFooter = "Example:\n  sextant convert points.txt session.yaml";
  return MakeCommand<ConvertOptions>("convert", "From one format of correspondences to another",
                                     kFooter, Declare, Run);
}

}  // namespace sextant::cli
