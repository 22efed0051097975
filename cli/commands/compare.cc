// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/pose_argument.h"
#include "cli/problem_input.h"
#include "cli/progress.h"
#include "eval/metrics/default_specs.h"
#include "eval/metrics/score.h"
#include "io/results/imported_poses.h"
#include "report/plot.h"
#include "report/report_text.h"
#include "solvers/all/all_solvers.h"

namespace sextant::cli {
namespace {

struct CompareOptions {
  ProblemInputOptions input{};
  std::string solvers{};             ///< Empty: every one whose needs the input meets.
  std::string plot_path{};           ///< Empty: none.
  std::string import_path{};         ///< See ReadImportedPoses; empty: none.
  std::vector<std::string> truth{};  ///< See PoseFromArgument; empty: that of the file, if any.
  std::string pose_is{};
};

void Declare(CompareOptions& options, Arguments& arguments) {
  DeclareProblemInput(options.input, arguments);
  arguments.Add("--solvers", options.solvers,
                "Solvers, separated by commas; default: every one whose needs the file meets");
  arguments.Add("--import", options.import_path,
                "poses.csv: poses of other programs as further rows; columns solver, x, y, z (m),\n"
                "qw, qx, qy, qz, and optionally time_us");
  arguments.Add("--truth", options.truth,
                std::string("The true pose, which adds the error of every answer: ") + kPoseHelp,
                {.min_values = 1, .max_values = 7});
  DeclarePoseIs(options.pose_is, arguments, "--truth");
  arguments.Add("--plot", options.plot_path,
                "Draw the residuals of every pair under every solver (.svg or .png)",
                {.writes = Writes::kFile});
}

// Whether a solver that finds the whole pose without a start has an answer; if there is none among
// them, whether any solver has one. The number of a mere baseline is no answer.
bool IsAnswered(const std::vector<ScoredRow>& rows) {
  const auto is_full = [](const ScoredRow& of) { return FindsWholePose(of.spec); };
  const bool any_full = std::any_of(rows.begin(), rows.end(), is_full);
  return std::any_of(rows.begin(), rows.end(), [&](const ScoredRow& of) {
    return of.row.report && (is_full(of) || !any_full);
  });
}

Expected<std::optional<Rigid3d>> TruthOf(const CompareOptions& options,
                                         const LoadedProblem& input) {
  if (options.truth.empty()) return input.file.true_cam_from_lidar;
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d truth,
                           PoseFromArgument("--truth", options.truth, options.pose_is));
  return truth;
}

// Each is held to every pair, and is a row of the table.
Expected<std::vector<ImportedPose>> ImportedPosesOf(const std::string& path) {
  constexpr std::size_t kMaxImported = 1000;
  if (path.empty()) return std::vector<ImportedPose>();
  SEXTANT_ASSIGN_OR_RETURN(std::vector<ImportedPose> poses, ReadImportedPoses(path));
  if (poses.size() <= kMaxImported) return poses;
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("--import: {} has {} poses, expected at most {} to compare", path,
                               poses.size(), kMaxImported));
}

ComparisonRow RowOf(const ImportedPose& imported, const CalibrationProblem& problem,
                    const std::optional<Rigid3d>& truth) {
  ComparisonRow row{imported.solver, SolveReport{}, {}, {}};
  row.report->solver = imported.solver;
  row.report->cam_from_lidar = imported.cam_from_lidar;
  row.report->wall_time_us = imported.time_us.value_or(std::numeric_limits<double>::quiet_NaN());
  row.report->evaluation = Evaluate(problem, imported.cam_from_lidar);
  if (truth) row.from_truth = DistanceBetween(imported.cam_from_lidar, *truth);
  return row;
}

/// All rows, best first: those of the solvers and those of other programs.
std::vector<ScoredRow> ScoredRows(std::vector<ComparisonRow> rows,
                                  const std::vector<SolverPtr>& solvers,
                                  const std::vector<ComparisonRow>& imported) {
  std::vector<SolverSpec> specs;
  for (const SolverPtr& solver : solvers) specs.push_back(solver->spec());
  for (const ComparisonRow& row : imported) {
    rows.push_back(row);
    specs.push_back({.name = row.solver});
  }
  return SortByScore(std::move(rows), specs);
}

int Run(const CompareOptions& options) {
  const SolverRegistry registry = AllSolvers(Commands::kAllowed);
  const Expected<LoadedProblem> input = LoadProblem(options.input);
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
  const Expected<std::optional<Rigid3d>> truth = TruthOf(options, *input);
  if (!truth) return Refuse("compare", truth.error());
  const Expected<std::vector<ImportedPose>> imported = ImportedPosesOf(options.import_path);
  if (!imported) return Refuse("compare", imported.error());
  Progress progress;
  std::vector<ComparisonRow> others;
  for (const ImportedPose& pose : *imported) others.push_back(RowOf(pose, problem, *truth));
  const std::vector<ScoredRow> scored =
      ScoredRows(Compare(problem, *solvers, *truth, progress.Callback()), *solvers, others);
  std::vector<ComparisonRow> rows;
  for (const ScoredRow& of : scored) rows.push_back(of.row);
  const bool answered = IsAnswered(scored);
  if (!answered) {
    const auto failed = std::find_if(rows.begin(), rows.end(),
                                     [](const ComparisonRow& row) { return !row.report; });
    PrintNoAnswer("compare", options.input, *input, *failed);
  }
  if (answered && !options.truth.empty() && rows.front().report) {
    WarnOfDirection("--truth", options.truth, options.pose_is, **truth,
                    rows.front().report->cam_from_lidar);
  }
  const std::string text = answered ? DescribeComparison(scored) : std::string();
  const int code = DeliverAnswers("compare", options.input, *input, rows, text, answered);
  // After the answers, which do not need gnuplot; without any there is nothing to draw.
  if (options.plot_path.empty() || !answered) return code;
  const Expected<void> drawn = DrawPlot(ResidualPlot(problem, rows), options.plot_path);
  return drawn ? code : Refuse("compare", drawn.error());
}

}  // namespace

Command CompareCommand() {
  constexpr const char* kFooter =
      "The best answer comes first, by a score that holds all answers to the same pairs: the root\n"
      "mean square of all residuals in robust standard deviations of the best, each at most 3.\n"
      "RMSE is over the pairs that an answer uses; `to first` is the distance to the best answer.\n"
      "Examples:\n"
      "  sextant compare points.txt\n"
      "  sextant compare points.txt --solvers "
      "'kabsch,icp(init=centroid),drop_worst(kabsch,keep=6)'";
  return MakeCommand<CompareOptions>("compare", "Many solvers on the same data, as a table",
                                     kFooter, Declare, Run);
}

}  // namespace sextant::cli
