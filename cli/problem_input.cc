// SPDX-License-Identifier: Apache-2.0
#include "cli/problem_input.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "base/version.h"
#include "cli/output.h"
#include "eval/diagnostics/outlying_pairs.h"
#include "eval/diagnostics/unexplained_pairs.h"
#include "io/boards/board_file.h"
#include "io/boards/marker_files.h"
#include "io/cameras/camera_file.h"
#include "io/output/standard_output.h"
#include "io/problems/read_problem.h"
#include "report/wrapped_text.h"
#include "solvers/all/all_solvers.h"
#include "solvers/core/evaluation.h"

namespace sextant::cli {
namespace {

// Only the sizes of the boards matter here, so a marker_coordinates.txt may have any number of
// them.
Expected<std::vector<Board>> ReadNamedBoards(const std::filesystem::path& path) {
  if (path.extension() == ".yaml" || path.extension() == ".yml") return ReadBoards(path);
  return ReadMarkerCoordinates(path).map(BoardsOf);
}

Expected<void> AddNamedFiles(const ProblemInputOptions& options, CalibrationProblem& problem) {
  if (!options.camera_path.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const Camera camera, ReadCamera(options.camera_path));
    problem.camera = camera;
  }
  if (!options.boards_path.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const std::vector<Board> boards, ReadNamedBoards(options.boards_path));
    problem.boards = boards;
  }
  return {};
}

// Too few pairs may be left of many.
std::string RepeatedText(const LoadedProblem& input) {
  std::size_t merged = 0;
  for (const RepeatedPairs& repeated : input.repeated) merged += repeated.merged.size();
  if (merged == 0) return {};
  const auto left = static_cast<std::size_t>(input.summary.pairs_3d3d + input.summary.pairs_2d3d);
  return fmt::format("; only {} of {} points differ", left, left + merged);
}

// What `input` shows of its only answer, where nothing else explains it.
std::vector<std::string> AnswerDiagnostics(const LoadedProblem& input, const SolveReport& report) {
  const CalibrationProblem& problem = input.file.problem;
  std::vector<std::string> lines = DescribeOutliers(report, input.repeated);
  const auto misfit = DescribeMisfit(problem, report);
  if (misfit && !input.diagnostics.contradiction) lines.push_back(*misfit);
  if (const auto distance = DescribeDistance(problem, report)) lines.push_back(*distance);
  if (const auto selection = DescribeSelection(problem, report)) lines.push_back(*selection);
  return lines;
}

// The noise of a coordinate by the only answer; 0 without one.
double NoiseOf(const std::vector<ComparisonRow>& rows, bool in_pixels) {
  if (rows.size() != 1 || !rows.front().report) return 0.0;
  const Evaluation& evaluation = rows.front().report->evaluation;
  return in_pixels ? SigmaByMedian(evaluation.per_pair_px, 2)
                   : SigmaByMedian(evaluation.per_pair_m, 3);
}

// Whether the better order exchanges few pairs for each other, and every answer leaves these out
// and explains them once they are exchanged back.
bool LeaveOutExchanged(const LoadedProblem& input, const std::vector<ComparisonRow>& rows) {
  constexpr double kAsLarge = 2.0;
  const std::optional<OrderFinding>& better = input.diagnostics.order.better;
  if (!better) return false;
  const std::vector<std::array<int, 2>> exchanged = ExchangedPairs(*better);
  const CalibrationProblem& problem = input.file.problem;
  const bool has_both_kinds = !problem.pairs_3d3d.empty() && !problem.pairs_2d3d.empty();
  if (exchanged.empty() || has_both_kinds) return false;
  const CalibrationProblem back = Reordered(problem, *better);
  for (const ComparisonRow& row : rows) {
    if (!row.report) continue;
    const std::vector<int>& used = row.report->inliers;
    const auto residuals_of = [&](const CalibrationProblem& pairs) {
      const Evaluation evaluation = Evaluate(pairs, row.report->cam_from_lidar);
      return better->in_pixels ? evaluation.per_pair_px : evaluation.per_pair_m;
    };
    const std::vector<double> as_given = residuals_of(problem);
    const std::vector<double> exchanged_back = residuals_of(back);
    double largest = 0.0;
    for (const int i : used) largest = std::max(largest, as_given[static_cast<std::size_t>(i)]);
    for (const auto& both : exchanged) {
      for (const int i : both) {
        const bool is_used = std::binary_search(used.begin(), used.end(), i);
        const double residual = exchanged_back[static_cast<std::size_t>(i)];
        if (is_used || !(residual <= kAsLarge * largest)) return false;
      }
    }
  }
  return true;
}

std::string DiagnosticsText(const LoadedProblem& input, const std::vector<ComparisonRow>& rows,
                            bool reordered) {
  std::string text;
  for (const std::string& line : input.notes) text += "  " + line + "\n";
  for (const RepeatedPairs& repeated : input.repeated) {
    const double sigma = NoiseOf(rows, repeated.in_pixels);
    for (const std::string& line : Describe(repeated, sigma)) text += "  " + line + "\n";
  }
  const bool has_one = rows.size() == 1 && rows.front().report;
  const PairDiagnostics diagnostics =
      has_one ? ForAnswer(input.diagnostics, input.file.problem, *rows.front().report)
              : input.diagnostics;
  for (const std::string& line : Describe(diagnostics, input.repeated)) text += "  " + line + "\n";
  if (input.rivals) text += "  " + Describe(*input.rivals, input.repeated) + "\n";
  const bool has_cause = !input.diagnostics.causes.empty();
  const bool is_misordered =
      input.diagnostics.order.better && !reordered && !LeaveOutExchanged(input, rows);
  const bool is_judged = has_cause || is_misordered || input.rivals;
  if (has_one && !is_judged) {
    for (const std::string& line : AnswerDiagnostics(input, *rows.front().report)) {
      text += "  " + line + "\n";
    }
  }
  if (reordered) text += "  " + DescribeReordering(input.diagnostics.order) + "\n";
  if (text.empty()) return text;
  return "\nData diagnostics:\n" + Narrow(text);
}

std::string ResultsJson(const LoadedProblem& input, const std::vector<ComparisonRow>& rows) {
  ResultFile results{.version = std::string(Version()), .input = input.summary, .results = {}};
  for (const ComparisonRow& row : rows) results.results.push_back({row.solver, row.report});
  return FormatResults(results);
}

// Several answers are judged by those that speak for a pose, or else by the best: pairs without a
// pose let some solver fit five of twenty.
std::vector<const SolveReport*> JudgedReports(const CalibrationProblem& problem,
                                              const std::vector<ComparisonRow>& rows) {
  std::vector<const SolveReport*> judged;
  const SolveReport* best = nullptr;
  for (const ComparisonRow& row : rows) {
    if (!row.report || row.report->inliers.empty()) continue;
    if (best == nullptr) best = &*row.report;
    if (IsSupported(problem, *row.report)) judged.push_back(&*row.report);
  }
  if (best != nullptr && (rows.size() == 1 || judged.empty())) judged = {best};
  return judged;
}

// Why the answer is not usable; none if it may be right.
std::optional<std::string> WhyRefuted(const LoadedProblem& input, const SolveReport& report,
                                      double share) {
  std::optional<std::string> why = WhyUnusable(input.file.problem, report);
  if (why || input.diagnostics.causes.empty() || share < kUsualUnexplainedShare) return why;
  return fmt::format(
      "the answer leaves {:.0f} percent of the spread of the measurements, and the data "
      "diagnostics below name a cause",
      100.0 * share);
}

// "" for answers of which one may be right.
std::string RefutingVerdict(const ProblemInputOptions& options, const LoadedProblem& input,
                            const std::vector<ComparisonRow>& rows) {
  // Answers that leave exchanged pairs out are as good as any.
  PairDiagnostics diagnostics = input.diagnostics;
  if (!options.reorder && LeaveOutExchanged(input, rows)) diagnostics.order.better.reset();
  if (RefutesPoses(diagnostics, options.reorder)) {
    return "NOT USABLE: the data diagnostics below name a fault that no solver corrects\n";
  }
  if (input.rivals) {
    return "NOT USABLE: two groups of pairs contradict each other, and the data does not determine "
           "which is right\n";
  }
  std::string least;
  double least_share = std::numeric_limits<double>::infinity();
  for (const SolveReport* report : JudgedReports(input.file.problem, rows)) {
    const double share = UnexplainedShare(input.file.problem, *report).value_or(0.0);
    std::optional<std::string> why = WhyRefuted(input, *report, share);
    if (!why) return "";
    if (least.empty() || share < least_share) {
      least = *std::move(why);
      least_share = share;
    }
  }
  return least.empty() ? "" : "NOT USABLE: " + least + "\n";
}

}  // namespace

void DeclareProblemInput(ProblemInputOptions& options, Arguments& arguments) {
  arguments.Add("FILE", options.problem_path, kCorrespondencesHelp, {.required = true});
  arguments.Add("--camera", options.camera_path,
                "Intrinsics: ROS camera_info YAML, OpenCV YAML, or .ini");
  arguments.Add("--boards", options.boards_path,
                "Known board sizes: a board file (YAML), or marker_coordinates.txt of the\n"
                "original package");
  arguments.Add("--reorder", options.reorder,
                "Use the order of the points of each board or view (up to 12) and of the boards\n"
                "that fits best, if it fits far better than that of the file and than others");
  arguments.Add("--json", options.json_path, "Write the results as JSON; - for standard output",
                {.writes = Writes::kFileOrStandardOutput});
}

Expected<LoadedProblem> LoadProblem(const ProblemInputOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const DetectedProblem read, ReadProblem(options.problem_path));
  LoadedProblem input;
  input.file = read;
  input.notes = read.notes;
  CalibrationProblem& problem = input.file.problem;
  SEXTANT_RETURN_IF_ERROR(AddNamedFiles(options, problem));
  input.repeated = MergeRepeatedPairs(problem);
  input.diagnostics = DiagnosePairs(problem);
  if (options.reorder && input.diagnostics.order.better) {
    problem = Reordered(problem, *input.diagnostics.order.better);
  }
  // A contradiction between boards, or data that is not what it seems, explains more.
  if (!input.diagnostics.contradiction && !RefutesPoses(input.diagnostics, options.reorder)) {
    input.rivals = FindRivalGroups(AllSolvers(), problem);
  }
  input.summary = {.path = options.problem_path,
                   .format = std::string(ToString(read.format)),
                   .pairs_3d3d = static_cast<int>(problem.pairs_3d3d.size()),
                   .pairs_2d3d = static_cast<int>(problem.pairs_2d3d.size()),
                   .points_in_cam = static_cast<int>(problem.point_sets.in_cam.size()),
                   .points_in_lidar = static_cast<int>(problem.point_sets.in_lidar.size())};
  return input;
}

Expected<std::vector<SolverPtr>> MakeSolvers(const SolverRegistry& registry,
                                             const std::vector<SpecNode>& specs) {
  std::vector<SolverPtr> solvers;
  for (const SpecNode& spec : specs) {
    SEXTANT_ASSIGN_OR_RETURN(SolverPtr solver, registry.Make(spec));
    solvers.push_back(std::move(solver));
  }
  return solvers;
}

void PrintNoAnswer(const char* command, const ProblemInputOptions& options,
                   const LoadedProblem& input, const ComparisonRow& row) {
  const Error& error = row.report.error();
  const std::string repeated =
      error.code == ErrorCode::kTooFewPairs ? RepeatedText(input) : std::string();
  Refuse(command, {error.code, fmt::format("{}: no answer of {}: {}{}", options.problem_path,
                                           row.solver, error.message, repeated)});
}

int DeliverAnswers(const char* command, const ProblemInputOptions& options,
                   const LoadedProblem& input, const std::vector<ComparisonRow>& rows,
                   const std::string& text, bool answered) {
  const std::string diagnostics = DiagnosticsText(input, rows, options.reorder);
  const std::string verdict = answered ? Narrow(RefutingVerdict(options, input, rows)) : "";
  if (options.json_path == "-") PrintError("{}{}", verdict, diagnostics);
  const int answer = verdict.empty() ? kAnswered : kNotUsable;
  return Deliver(command, options.json_path, verdict + text + diagnostics, ResultsJson(input, rows),
                 answered ? answer : kNoAnswer);
}

}  // namespace sextant::cli
