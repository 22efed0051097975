// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "solvers/rig/rig_information.h"
#include "solvers/rig/rig_model.h"

namespace sextant {

/// Standard deviation over the stated one, for each sensor and RigKind.
using RigNoise = std::vector<std::array<double, kRigKinds>>;

double& LevelOf(RigNoise& noise, std::size_t sensor, RigKind kind);
double LevelOf(const RigNoise& noise, std::size_t sensor, RigKind kind);

/// The whitened residuals of each unit at a state: root of the mean square over its rows; infinite
/// where there is none.
using RigUnits = std::vector<std::vector<double>>;  ///< One list for each block.
RigUnits UnitsAt(const RigModel& model, const RigState& state);

/// (rotation times lever, translation) [m] of a shift.
Vector6d ShiftAt(const RigModel& model, const RigState& state, std::size_t placement,
                 std::size_t shift);

/// Levels by the medians, at least 1: robust to nearly half of a sensor's observations being wrong.
/// Those of the shifts are at least `loose_m` over their sigma.
RigNoise MedianLevels(const RigModel& model, const RigState& state, const RigUnits& units,
                      double loose_m);

/// Variance components (Helmert; Foerstner 1979): see EstimateNoise in solvers/joint.
RigNoise EstimatedLevels(const RigModel& model, const RigLinearisation& at,
                         const RigInformation& information, const RigNoise& before);

/// Sets the level of the shifts of sensors that have none to 1.
void ClearAbsentShifts(const RigModel& model, RigNoise& noise);

bool IsSameLevels(const RigNoise& a, const RigNoise& b);

/// Which units of each block are used.
using RigSelection = std::vector<std::vector<bool>>;

/// The root of the slope of Cauchy's loss over the level, for what is selected; 0 for all else.
/// `loss_scale`: infinite for least squares.
RigWeights WeightsFor(const RigModel& model, const RigState& state, const RigUnits& units,
                      const RigSelection& selection, const RigNoise& noise, double loss_scale);

/// The largest residual of a unit with that many rows, in levels, at that many sigmas.
double UnitLimit(int rows, double sigmas);

}  // namespace sextant
