// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/left_out.h"

#include <charconv>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

namespace sextant {
namespace {

using ViewAndBoard = std::pair<int, int>;  // PairId::view, and Board::id.

// An unused board of one sensor only gives no information, but contradicts nothing.
const char* WhyLeftOut(const BoardViewFit& fit) {
  return fit.printed.of == 0 || fit.face.of + fit.edges.of == 0
             ? "only one of the sensors has raw observations of it"
             : "its image and its scan contradict the other views: was the board still, and is the "
               "scan of the same moment?";
}

void MarkRow(const BoardViewFit& fit, Assembly& assembly) {
  for (BoardRow& row : assembly.rows) {
    if (row.view != static_cast<std::size_t>(fit.view) || row.board < 0) continue;
    if (assembly.problem.boards[static_cast<std::size_t>(row.board)].id != fit.board) continue;
    row.fate = BoardStatus::kContradicts;
    row.why = WhyLeftOut(fit);
  }
}

// Board views, matches and fits have one order.
void RemoveBoards(std::span<const BoardViewFit> fits, const std::set<ViewAndBoard>& unused,
                  Assembly& assembly) {
  CalibrationProblem& problem = assembly.problem;
  std::vector<MatchedBoard> kept;
  std::vector<BoardView> board_views;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits[i].used) continue;
    kept.push_back(assembly.matching.kept[i]);
    board_views.push_back(std::move(problem.board_views[i]));
  }
  assembly.matching.kept = std::move(kept);
  problem.board_views = std::move(board_views);
  const auto is_unused = [&](const auto& pair) {
    return unused.contains({pair.id.view, pair.id.board});
  };
  std::erase_if(problem.pairs_3d3d, is_unused);
  std::erase_if(problem.pairs_2d3d, is_unused);
  problem.point_sets = WithholdPairing(problem.pairs_3d3d);
}

// The solver's inliers are the pairs of the boards that it uses.
void EvaluateAgain(const CalibrationProblem& problem, SolveReport& report) {
  CalibrationProblem seen = problem;
  if (report.camera) seen.camera = report.camera->camera;
  report.evaluation = Evaluate(seen, report.cam_from_lidar);
  std::erase_if(report.board_views, [](const BoardViewFit& fit) { return !fit.used; });
  std::iota(report.inliers.begin(), report.inliers.end(), 0);
}

}  // namespace

void LeaveOut(SolveReport& report, Assembly& assembly) {
  std::set<ViewAndBoard> unused;
  for (const BoardViewFit& fit : report.board_views) {
    if (!fit.used) unused.emplace(fit.view, fit.board);
  }
  if (unused.empty() || unused.size() == report.board_views.size()) return;
  for (const BoardViewFit& fit : report.board_views) {
    if (!fit.used) MarkRow(fit, assembly);
  }
  RemoveBoards(report.board_views, unused, assembly);
  EvaluateAgain(assembly.problem, report);
}

std::string WithViewNames(std::string_view text, std::span<const SessionView> views) {
  constexpr std::string_view kWord = "view ";
  std::string named;
  std::size_t from = 0;
  for (std::size_t at = text.find(kWord); at != std::string_view::npos;
       at = text.find(kWord, from)) {
    const std::size_t number = at + kWord.size();
    named += text.substr(from, number - from);
    std::size_t view = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + number, end, view);
    from = number;
    if (error != std::errc() || view >= views.size() || views[view].name.empty()) continue;
    named += views[view].name;
    from = static_cast<std::size_t>(stop - text.data());
  }
  return named + std::string(text.substr(from));
}

}  // namespace sextant
