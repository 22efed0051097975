// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/crs_matrix.h>
#include <ceres/problem.h>

#include <array>
#include <vector>

#include "solvers/blocks/pose_manifold.h"
#include "solvers/blocks/schur_minimum.h"
#include "solvers/rig/rig_model.h"

namespace sextant {

/// Factors of the whitened residuals; 0 leaves them out.
struct RigWeights {
  std::vector<std::vector<double>> blocks;         ///< One for each unit of each block.
  std::vector<std::vector<Vector6d>> shifts_by_m;  ///< As ShiftAt has them.
};

/// Rows of a linearisation: residuals of one block, or of one shift's prior.
struct RigRows {
  std::size_t placement = 0;
  std::size_t sensor = 0;
  int block = -1;  ///< Index into RigModel::blocks; -1: the prior of a shift.
  int first = 0;
  int count = 0;
};

/// Weighted residuals and their derivative by (dphi, dt) of the poses sensor_from_root of all
/// sensors but the root, in their order, then the shared numbers, then (dphi, dt) of each
/// placement's board and shifts.
struct RigLinearisation {
  int shared = 0;                 ///< Columns before those of the placements.
  std::vector<int> first_column;  ///< Each placement's, and one past the last.
  std::vector<double> residuals;
  ceres::CRSMatrix derivative;
  std::vector<RigRows> rows;  ///< By placement; those of the numbers' priors are in none.
};

/// argmin of 1/2 sum |w r|^2 over the poses of the sensors, the boards and their shifts, and the
/// shared numbers, as a ceres::Problem. A placement's poses are one parameter block, which the
/// Schur complement eliminates, so that an iteration is linear in the number of placements (Triggs
/// et al. 2000).
class RigMinimum {
 public:
  RigMinimum(const RigModel& model, std::size_t root, const RigState& start);
  RigMinimum(const RigMinimum&) = delete;
  RigMinimum& operator=(const RigMinimum&) = delete;

  const RigState& state() const { return state_; }

  void SetWeights(const RigWeights& weights);

  SchurSteps Solve(int max_iterations, double step_tolerance);

  RigLinearisation Linearise();

 private:
  void AddBlock(std::size_t index);
  void AddShifts(std::size_t placement);
  void AddNumbers();
  void Load(const RigState& state);
  void Store();

  const RigModel& model_;
  std::size_t root_;
  RigState state_;
  RigWeights weights_;
  std::vector<std::array<double, kPoseNumbers>> sensors_;
  std::vector<std::vector<double>> placements_;
  std::vector<ceres::ResidualBlockId> residuals_;
  std::vector<RigRows> rows_;
  int row_count_ = 0;
  ceres::Problem problem_;
};

}  // namespace sextant
