// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/make_result.h"

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "base/version.h"
#include "calibrate/trust/closing.h"

namespace sextant {
namespace {

// The residuals of one kind of pairs that belong to a board in a view.
template <class Pair>
std::vector<double> ResidualsOf(const std::vector<Pair>& pairs,
                                const std::vector<double>& residuals, int view, int board) {
  std::vector<double> found;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (pairs[i].id.view == view && pairs[i].id.board == board) found.push_back(residuals[i]);
  }
  return found;
}

std::optional<double> RmsOfAll(const std::vector<ResultBoardView>& boards,
                               std::vector<double> ResultBoardView::*residuals) {
  double squares = 0.0;
  int count = 0;
  for (const ResultBoardView& board : boards) {
    for (const double residual : board.*residuals) {
      squares += residual * residual;
      ++count;
    }
  }
  if (count == 0) return std::nullopt;
  return std::sqrt(squares / count);
}

std::vector<ResultBoardView> BoardsOf(const CalibrationProblem& problem,
                                      const Evaluation& evaluation, int view) {
  std::vector<ResultBoardView> boards;
  for (const BoardView& seen : problem.board_views) {
    if (seen.view != view) continue;
    boards.push_back(
        {.board = seen.board,
         .cam_from_board = seen.cam_from_board,
         .lidar_from_board = seen.lidar_from_board,
         .residuals_m = ResidualsOf(problem.pairs_3d3d, evaluation.per_pair_m, view, seen.board),
         .residuals_px =
             ResidualsOf(problem.pairs_2d3d, evaluation.per_pair_px, view, seen.board)});
  }
  return boards;
}

// Why no board of the view was kept.
std::string ReasonOf(const Assembly& assembly, std::size_t view) {
  std::string reason;
  for (const BoardRow& row : assembly.rows) {
    if (row.view != view) continue;
    if (!reason.empty()) reason += "; ";
    if (row.board >= 0) {
      reason +=
          fmt::format("board {} ", assembly.problem.boards[static_cast<std::size_t>(row.board)].id);
    }
    reason += fmt::format("{}: {}", ToString(row.fate), row.why);
  }
  return reason;
}

ResultView ViewOf(const SessionView& seen, std::size_t index, const Assembly& assembly,
                  const SolveReport& report) {
  ResultView view{.view = static_cast<int>(index),
                  .name = seen.name,
                  .image_path = seen.image_path,
                  .cloud_path = seen.cloud_path,
                  .image_time_s = seen.image_time_s,
                  .cloud_time_s = seen.cloud_time_s};
  view.boards = BoardsOf(assembly.problem, report.evaluation, view.view);
  view.kept = !view.boards.empty();
  if (!view.kept) view.reason = ReasonOf(assembly, index);
  view.rmse_m = RmsOfAll(view.boards, &ResultBoardView::residuals_m);
  view.rmse_px = RmsOfAll(view.boards, &ResultBoardView::residuals_px);
  return view;
}

}  // namespace

CalibrationResult MakeResult(std::span<const SessionView> views, const Assembly& assembly,
                             const SolveReport& report, const ResultSettings& settings) {
  CalibrationResult result;
  result.version = std::string(Version());
  result.solver = report.solver;
  result.seed = settings.seed;
  result.configuration = settings.configuration;
  result.cam_from_lidar = report.cam_from_lidar;
  result.covariance = report.covariance;
  result.camera = assembly.problem.camera;
  result.boards = assembly.problem.boards;
  for (const SessionView& view : views) {
    if (!view.seen || result.lidar) continue;
    result.lidar = view.seen->lidar;
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    result.views.push_back(ViewOf(views[i], i, assembly, report));
  }
  result.warnings = settings.warnings;
  result.closing = ClosingParagraph(assembly, report);
  return result;
}

}  // namespace sextant
