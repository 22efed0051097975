// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>

#include "base/units.h"
#include "base/version.h"
#include "cli/catalogue.h"
#include "cli/commands.h"
#include "cli/load.h"
#include "eval/metrics/compare.h"
#include "eval/metrics/default_specs.h"
#include "report/overlay.h"
#include "report/plot.h"
#include "report/report_text.h"

namespace sextant::cli {
namespace {

Expected<std::vector<SolverPtr>> MakeSolvers(const SolverRegistry& registry,
                                             const std::vector<SpecNode>& specs) {
  std::vector<SolverPtr> solvers;
  for (const SpecNode& spec : specs) {
    SEXTANT_ASSIGN_OR_RETURN(SolverPtr solver, registry.Make(spec));
    solvers.push_back(std::move(solver));
  }
  return solvers;
}

std::string FindingsText(const LoadedInput& input, bool reordered) {
  std::string text;
  for (const std::string& line : input.notes) text += "  " + line + "\n";
  for (const std::string& line : Describe(input.judgement)) text += "  " + line + "\n";
  if (text.empty()) return text;
  if (reordered && input.judgement.order) {
    text += "  the order above was taken, as --reorder asks\n";
  }
  return "\nWhat the data says of itself:\n" + text;
}

std::string JsonOf(const LoadedInput& input, const std::vector<ComparisonRow>& rows) {
  ResultFile results{.version = std::string(Version()), .input = input.summary, .results = {}};
  for (const ComparisonRow& row : rows) results.results.push_back({row.solver, row.report});
  return FormatResults(results);
}

// Whether a solver answered that finds the whole pose from anywhere; where none such was asked for,
// whether any did. A baseline's number for data that has no answer is none.
bool IsAnswered(const std::vector<SolverPtr>& solvers, const std::vector<ComparisonRow>& rows) {
  const auto is_full = [](const SolverPtr& solver) { return FindsWholePose(solver->spec()); };
  const bool any_full = std::any_of(solvers.begin(), solvers.end(), is_full);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].report && (is_full(solvers[i]) || !any_full)) return true;
  }
  return false;
}

// The file is named, for the solver does not know where its pairs came from.
void RefuseProblem(const char* command, const InputOptions& options, const ComparisonRow& row) {
  const Error& error = row.report.error();
  Refuse(command, {error.code, fmt::format("{}: no answer of {}: {}", options.problem_path,
                                           row.solver, error.message)});
}

int DeliverAnswers(const char* command, const InputOptions& options, const LoadedInput& input,
                   const std::vector<ComparisonRow>& rows, const std::string& text, bool answered) {
  const std::string findings = FindingsText(input, options.reorder);
  if (options.json_path == "-") fmt::print(stderr, "{}", findings);
  return Deliver(command, options.json_path, text + findings, JsonOf(input, rows),
                 answered ? kAnswered : kNoAnswer);
}

}  // namespace

int RunSolve(const SolveOptions& options) {
  const Expected<SolverPtr> solver = AllSolvers().Make(options.solver);
  if (!solver) return Refuse("solve", solver.error());
  const Expected<LoadedInput> input = Load(options.input);
  if (!input) return Refuse("solve", input.error());
  const CalibrationProblem& problem = input->file.problem;
  const std::vector<ComparisonRow> rows =
      Compare(problem, {&*solver, 1}, input->file.true_cam_from_lidar);
  const ComparisonRow& row = rows.front();
  std::string text;
  if (row.report) {
    text = DescribeReport(problem, (*solver)->spec(), *row.report);
    if (row.from_truth) {
      text += fmt::format("  error against the truth    {:.2f} mm, {:.4f} deg\n",
                          row.from_truth->translation_m * 1e3,
                          row.from_truth->rotation_rad * kDegPerRad);
    }
    if (!options.overlay.empty()) {
      const Expected<void> drawn =
          DrawOverlay(problem, *row.report, options.overlay[0], options.overlay[1]);
      if (!drawn) return Refuse("solve", drawn.error());
    }
  } else {
    RefuseProblem("solve", options.input, row);
  }
  return DeliverAnswers("solve", options.input, *input, rows, text, row.report.has_value());
}

int RunCompare(const CompareOptions& options) {
  const SolverRegistry registry = AllSolvers();
  const Expected<LoadedInput> input = Load(options.input);
  if (!input) return Refuse("compare", input.error());
  const CalibrationProblem& problem = input->file.problem;
  std::string list = options.solvers;
  if (list.empty()) list = fmt::format("{}", fmt::join(DefaultSpecs(registry, problem), ","));
  if (list.empty()) {
    return Refuse("compare",
                  {ErrorCode::kMissingData,
                   fmt::format("{}: no solver finds a pose from {} 3D-3D pairs and {} 2D-3D pairs; "
                               "expected at least 3, and the camera for 2D-3D pairs (--camera)",
                               options.input.problem_path, problem.pairs_3d3d.size(),
                               problem.pairs_2d3d.size())},
                  kNoAnswer);
  }
  const Expected<std::vector<SolverPtr>> solvers =
      ParseSpecList(list).and_then([&](const auto& specs) { return MakeSolvers(registry, specs); });
  if (!solvers) return Refuse("compare", solvers.error());
  const std::vector<ComparisonRow> rows =
      Compare(problem, *solvers, input->file.true_cam_from_lidar);
  if (!options.plot_path.empty()) {
    const Expected<void> drawn = DrawPlot(ResidualPlot(problem, rows), options.plot_path);
    if (!drawn) return Refuse("compare", drawn.error());
  }
  const bool answered = IsAnswered(*solvers, rows);
  if (!answered) {
    const auto failed = std::find_if(rows.begin(), rows.end(),
                                     [](const ComparisonRow& row) { return !row.report; });
    RefuseProblem("compare", options.input, *failed);
  }
  const std::string text = answered ? DescribeComparison(rows) : std::string();
  return DeliverAnswers("compare", options.input, *input, rows, text, answered);
}

}  // namespace sextant::cli
