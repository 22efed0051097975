// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/subset.h"

#include "solvers/core/solver.h"

namespace sextant {
namespace {

template <class Pair>
std::vector<Pair> Select(const std::vector<Pair>& pairs, std::span<const int> indices) {
  std::vector<Pair> selected;
  selected.reserve(indices.size());
  for (const int i : indices) selected.push_back(pairs[static_cast<std::size_t>(i)]);
  return selected;
}

}  // namespace

CalibrationProblem SubsetOf(const CalibrationProblem& problem, const DataNeeds& needs,
                            std::span<const int> indices) {
  CalibrationProblem subset;
  subset.camera = problem.camera;
  subset.boards = problem.boards;
  subset.initial_cam_from_lidar = problem.initial_cam_from_lidar;
  // clang-tidy 14 takes the two for the same.
  if (needs.pairs_3d3d > 0) {  // NOLINT(bugprone-branch-clone)
    subset.pairs_3d3d = Select(problem.pairs_3d3d, indices);
  } else {
    subset.pairs_2d3d = Select(problem.pairs_2d3d, indices);
  }
  return subset;
}

}  // namespace sextant
