// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/compare.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/pose_argument.h"
#include "cli/problem_input.h"
#include "cli/progress.h"
#include "eval/metrics/default_specs.h"
#include "report/plot.h"
#include "report/report_text.h"
#include "solvers/all/all_solvers.h"

namespace sextant::cli {
namespace {

struct CompareOptions {
  ProblemInputOptions input{};
  std::string truth_path{};  ///< Empty: the truth of the problem, if it has one.
  std::string pose_is{};
  std::string solvers{};    ///< Empty: every one whose needs the input meets.
  std::string plot_path{};  ///< Empty: none.
};

void Declare(CompareOptions& options, Arguments& arguments) {
  DeclareProblemInput(options.input, arguments);
  arguments.Add("--solvers", options.solvers,
                "Solvers, separated by commas; default: every one whose needs the file meets");
  arguments.Add("--truth", options.truth_path,
                std::string("The true pose, for the distances: ") + kPoseHelp);
  DeclarePoseIs(options.pose_is, arguments);
  arguments.Add("--plot", options.plot_path,
                "Draw the residuals of every pair under every solver (.svg or .png)",
                {.writes = Writes::kFile});
}

// Whether a solver that finds the whole pose without a start has an answer; if there is none among
// them, whether any solver has one. The number of a mere baseline is no answer.
bool IsAnswered(const std::vector<SolverPtr>& solvers, const std::vector<ComparisonRow>& rows) {
  const auto is_full = [](const SolverPtr& solver) { return FindsWholePose(solver->spec()); };
  const bool any_full = std::any_of(solvers.begin(), solvers.end(), is_full);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].report && (is_full(solvers[i]) || !any_full)) return true;
  }
  return false;
}

int Run(const CompareOptions& options) {
  const SolverRegistry registry = AllSolvers();
  Expected<LoadedProblem> input = LoadProblem(options.input);
  if (!input) return Refuse("compare", input.error());
  if (!options.truth_path.empty()) {
    const Expected<Rigid3d> truth = PoseOfFile(options.truth_path, options.pose_is);
    if (!truth) return Refuse("compare", truth.error());
    input->file.true_cam_from_lidar = *truth;
  }
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
  Progress progress;
  const std::vector<ComparisonRow> rows =
      Compare(problem, *solvers, input->file.true_cam_from_lidar, progress.Callback());
  if (!options.plot_path.empty()) {
    const Expected<void> drawn = DrawPlot(ResidualPlot(problem, rows), options.plot_path);
    if (!drawn) return Refuse("compare", drawn.error());
  }
  const bool answered = IsAnswered(*solvers, rows);
  if (!answered) {
    const auto failed = std::find_if(rows.begin(), rows.end(),
                                     [](const ComparisonRow& row) { return !row.report; });
    PrintNoAnswer("compare", options.input, *input, *failed);
  }
  const std::string text = answered ? DescribeComparison(rows) : std::string();
  return DeliverAnswers("compare", options.input, *input, rows, text, answered);
}

}  // namespace

Command CompareCommand() {
  constexpr const char* kFooter =
      "The table has the distance of each answer to the first one, and to the truth if the file "
      "holds it.\n"
      "Examples:\n"
      "  sextant compare points.txt\n"
      "  sextant compare points.txt --solvers "
      "'kabsch,icp(init=centroid),drop_worst(kabsch,keep=6)'";
  return MakeCommand<CompareOptions>("compare", "Many solvers on the same data, as a table",
                                     kFooter, Declare, Run);
}

}  // namespace sextant::cli
