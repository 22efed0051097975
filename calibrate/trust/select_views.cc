// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/select_views.h"

#include <algorithm>
#include <set>

namespace sextant {
namespace {

// The problem without the data of its views.
CalibrationProblem WithoutData(const CalibrationProblem& problem) {
  CalibrationProblem bare;
  bare.camera = problem.camera;
  bare.boards = problem.boards;
  bare.lidar_errors = problem.lidar_errors;
  bare.initial_cam_from_lidar = problem.initial_cam_from_lidar;
  return bare;
}

// Appends the data of a view under another number.
void Append(const CalibrationProblem& from, int view, int number, CalibrationProblem& to) {
  for (Pair3d3d pair : from.pairs_3d3d) {
    if (pair.id.view != view) continue;
    pair.id.view = number;
    to.pairs_3d3d.push_back(pair);
  }
  for (Pair2d3d pair : from.pairs_2d3d) {
    if (pair.id.view != view) continue;
    pair.id.view = number;
    to.pairs_2d3d.push_back(pair);
  }
  for (const BoardView& board : from.board_views) {
    if (board.view != view) continue;
    to.board_views.push_back(board);
    to.board_views.back().view = number;
  }
}

}  // namespace

std::vector<int> ViewsOf(const CalibrationProblem& problem) {
  std::set<int> views;
  for (const Pair3d3d& pair : problem.pairs_3d3d) views.insert(pair.id.view);
  for (const Pair2d3d& pair : problem.pairs_2d3d) views.insert(pair.id.view);
  for (const BoardView& board : problem.board_views) views.insert(board.view);
  return {views.begin(), views.end()};
}

CalibrationProblem SelectViews(const CalibrationProblem& problem, std::span<const int> views) {
  CalibrationProblem selected = WithoutData(problem);
  for (const int view : views) Append(problem, view, view, selected);
  selected.point_sets = WithholdPairing(selected.pairs_3d3d);
  return selected;
}

CalibrationProblem ResampleViews(const CalibrationProblem& problem, std::span<const int> drawn) {
  CalibrationProblem selected = WithoutData(problem);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    Append(problem, drawn[i], static_cast<int>(i), selected);
  }
  selected.point_sets = WithholdPairing(selected.pairs_3d3d);
  return selected;
}

}  // namespace sextant
