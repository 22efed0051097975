// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/run/export_problems.h"

#include <fmt/core.h>

#include "base/text/escape.h"
#include "io/output/output_file.h"
#include "io/output/output_folder.h"
#include "io/problems/problem_yaml.h"

namespace sextant {

Expected<void> ExportProblems(const Experiment& experiment, const std::filesystem::path& folder) {
  SEXTANT_ASSIGN_OR_RETURN(const OutputFolder locked, OutputFolder::Open(folder));
  std::string list = "condition,trial,file\n";
  for (std::size_t c = 0; c < experiment.conditions.size(); ++c) {
    const Condition& condition = experiment.conditions[c];
    const std::string place = fmt::format("{:03}", c + 1);
    SEXTANT_RETURN_IF_ERROR(MakeSubfolder(folder / place));
    for (std::uint64_t trial = 0; trial < experiment.trials; ++trial) {
      SEXTANT_ASSIGN_OR_RETURN(
          CalibrationProblem problem,
          condition.trials->ProblemOf({trial, SeedOf(experiment, condition, trial)}));
      const std::string file = fmt::format("{}/{}.yaml", place, trial);
      const std::string comment =
          fmt::format("{}, {}, trial {}", experiment.name, condition.name, trial);
      SEXTANT_RETURN_IF_ERROR(
          WriteFileAtomically(folder / file, FormatProblemYaml({std::move(problem), {}, comment})));
      list += fmt::format("{},{},{}\n", CsvField(condition.name), trial, file);
    }
  }
  return WriteFileAtomically(folder / "problems.csv", list);
}

}  // namespace sextant
