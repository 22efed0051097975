// SPDX-License-Identifier: Apache-2.0
#include "solvers/external/imported_solver.h"

#include <fmt/format.h>

#include <memory>
#include <set>
#include <vector>

#include "base/nearest_name.h"
#include "base/spec_text.h"
#include "io/results/imported_poses.h"
#include "solvers/core/evaluation.h"

namespace sextant {
namespace {

constexpr const char* kSolverOption = "solver";

// The name that is asked for, or the only one.
Expected<std::string> ChosenName(const std::vector<ImportedPose>& poses, const std::string& wanted,
                                 const std::string& file) {
  std::set<std::string> names;
  for (const ImportedPose& pose : poses) names.insert(pose.solver);
  if (wanted.empty() && names.size() == 1) return *names.begin();
  if (names.contains(wanted)) return wanted;
  const std::vector<std::string> known(names.begin(), names.end());
  return MakeError(
      ErrorCode::kInvalidOption,
      wanted.empty()
          ? fmt::format("{} has poses of {}; choose with solver=NAME", file, fmt::join(known, ", "))
          : fmt::format("{} has no poses of '{}'; {}", file, wanted, SuggestName(wanted, known)));
}

Expected<SolverPtr> MakeImported(const SolverArguments& arguments) {
  std::string file;
  std::string wanted;
  for (const auto& [key, value] : arguments.options) {
    if (key == kSpecText) file = value;
    if (key == kSolverOption) wanted = value;
  }
  if (file.empty()) {
    return MakeError(ErrorCode::kInvalidOption,
                     "solver 'imported': expected a file in double quotes, as "
                     "imported(\"poses.csv\")");
  }
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<ImportedPose> poses, ReadImportedPoses(file));
  SEXTANT_ASSIGN_OR_RETURN(const std::string name, ChosenName(poses, wanted, file));
  ImportedSolver::Poses of_name;
  for (const ImportedPose& pose : poses) {
    if (pose.solver == name) of_name[{pose.condition, pose.trial}] = pose.cam_from_lidar;
  }
  return std::make_shared<ImportedSolver>(arguments.name, std::move(of_name));
}

}  // namespace

Expected<SolveReport> ImportedSolver::AnswerTo(const CalibrationProblem& problem,
                                               const std::string& condition,
                                               std::uint64_t trial) const {
  const auto found = poses_.find({condition, trial});
  if (found == poses_.end()) {
    return MakeError(
        ErrorCode::kNoConsensus,
        fmt::format("{}: the file has no pose of trial {} of '{}'", spec().name, trial, condition));
  }
  SolveReport report;
  report.solver = spec().name;
  report.cam_from_lidar = found->second;
  report.evaluation = Evaluate(problem, found->second);
  return report;
}

Expected<Estimate> ImportedSolver::DoSolve(const CalibrationProblem& /*problem*/) const {
  return MakeError(ErrorCode::kMissingData,
                   spec().name +
                       " has poses of the trials of an experiment only; 'compare --import' takes "
                       "poses of one problem");
}

Expected<SolveReport> SolveTrial(const Solver& solver, const CalibrationProblem& problem,
                                 const std::string& condition, std::uint64_t trial) {
  const auto* imported = dynamic_cast<const ImportedSolver*>(&solver);
  return imported != nullptr ? imported->AnswerTo(problem, condition, trial)
                             : solver.Solve(problem);
}

SolverEntry ImportedEntry() {
  return {
      .name = "imported",
      .summary = "poses that another program computed for the trials of an experiment",
      .needs = "a file with a pose for each trial",
      .reference = "docs/formats.md, Solvers of other programs",
      .example = "imported(\"poses.csv\")",
      .options = {{kSpecText, "", "path", "the file, in double quotes"},
                  {kSolverOption, "", "name", "whose poses, where the file has several"}},
      .make = MakeImported,
  };
}

}  // namespace sextant
