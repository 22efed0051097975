// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/rig_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/median.h"

namespace sextant {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Median of the absolute value of a standard normal variable.
constexpr double kMedianOfNormal = 0.6744897501960817;

RigKind ShiftKind(std::size_t along) {
  return kShiftIsOutOfPlane[along] ? RigKind::kShiftOut : RigKind::kShiftIn;
}

double SlopeRoot(double residual, double limit) {
  if (!std::isfinite(limit)) return 1.0;
  const double ratio = residual / limit;
  return 1.0 / std::sqrt(1.0 + ratio * ratio);
}

using KindSums = std::array<RigSum, kRigKinds>;

std::vector<KindSums> SumsByKind(const RigModel& model, const RigLinearisation& at,
                                 const RigInformation& information) {
  std::vector<KindSums> sums(model.sensors);
  const auto add = [&](std::size_t sensor, RigKind kind, const RigSum& sum) {
    RigSum& to = sums[sensor][static_cast<std::size_t>(kind)];
    to.squares += sum.squares;
    to.redundancy += sum.redundancy;
  };
  for (std::size_t k = 0; k < at.rows.size(); ++k) {
    const RigRows& rows = at.rows[k];
    if (rows.block == kMotionRows) continue;
    if (rows.block == kShiftRows) {
      add(rows.sensor, RigKind::kShiftOut, information.sums[k]);
      add(rows.sensor, RigKind::kShiftIn, information.in_plane[k]);
    } else {
      add(rows.sensor, model.blocks[static_cast<std::size_t>(rows.block)].kind,
          information.sums[k]);
    }
  }
  return sums;
}

std::vector<bool> SensorsWithShifts(const RigModel& model) {
  std::vector<bool> shifts(model.sensors, false);
  for (const RigPlacementModel& placement : model.placements) {
    for (const RigShift& shift : placement.shifts) {
      if (shift.sigma_m > kMinShift_m) shifts[shift.sensor] = true;
    }
  }
  return shifts;
}

}  // namespace

double& LevelOf(RigNoise& noise, std::size_t sensor, RigKind kind) {
  return noise[sensor][static_cast<std::size_t>(kind)];
}
double LevelOf(const RigNoise& noise, std::size_t sensor, RigKind kind) {
  return noise[sensor][static_cast<std::size_t>(kind)];
}

// What is common to a unit, such as blur or a wrong corner, makes its rows count as those of one
// point in the plane.
double UnitLimit(int rows, double sigmas) {
  return rows == 1 ? sigmas : 1.0 + sigmas * std::sqrt(0.5 / 2.0);
}

RigUnits UnitsAt(const RigModel& model, const RigState& state) {
  RigUnits units;
  RigResiduals at;
  for (const RigBlock& block : model.blocks) {
    units.emplace_back(static_cast<std::size_t>(block.units), kInfinite);
    if (!block.residuals(SensorFromBoardOf(model, state, block), at)) continue;
    for (const RigNumberUse& use : block.numbers) at.value += state.numbers[use.number] * use.by;
    for (int i = 0; i < block.units; ++i) {
      const auto rows = at.value.segment(i * block.rows_per_unit, block.rows_per_unit);
      units.back()[static_cast<std::size_t>(i)] = rows.norm() / std::sqrt(block.rows_per_unit);
    }
  }
  return units;
}

Vector6d ShiftAt(const RigModel& model, const RigState& state, std::size_t placement,
                 std::size_t shift) {
  const Rigid3d& pose = state.shifts[placement][shift];
  Vector6d value;
  value << model.placements[placement].shifts[shift].lever_m * LogSo3(pose.rotation),
      pose.translation;
  return value;
}

RigNoise MedianLevels(const RigModel& model, const RigState& state, const RigUnits& units,
                      double loose_m) {
  std::vector<std::array<std::vector<double>, kRigKinds>> values(model.sensors);
  for (std::size_t k = 0; k < units.size(); ++k) {
    const RigBlock& block = model.blocks[k];
    auto& of = values[block.sensor][static_cast<std::size_t>(block.kind)];
    for (const double value : units[k]) {
      of.push_back(block.rows_per_unit == 1 ? value / kMedianOfNormal : value);
    }
  }
  RigNoise noise(model.sensors);
  for (auto& levels : noise) levels.fill(1.0);
  for (std::size_t i = 0; i < model.placements.size(); ++i) {
    const auto& shifts = model.placements[i].shifts;
    for (std::size_t s = 0; s < shifts.size(); ++s) {
      const double norm = ShiftAt(model, state, i, s).norm() / std::sqrt(6.0);
      for (const RigKind kind : {RigKind::kShiftOut, RigKind::kShiftIn}) {
        values[shifts[s].sensor][static_cast<std::size_t>(kind)].push_back(norm /
                                                                           shifts[s].sigma_m);
        LevelOf(noise, shifts[s].sensor, kind) = std::max(1.0, loose_m / shifts[s].sigma_m);
      }
    }
  }
  for (std::size_t s = 0; s < values.size(); ++s) {
    for (std::size_t kind = 0; kind < kRigKinds; ++kind) {
      const double median = UpperMedian(values[s][kind]);
      if (std::isfinite(median)) noise[s][kind] = std::max(noise[s][kind], median);
    }
  }
  return noise;
}

RigNoise EstimatedLevels(const RigModel& model, const RigLinearisation& at,
                         const RigInformation& information, const RigNoise& before) {
  constexpr double kPriorResiduals = 10.0;
  constexpr double kPriorShifts = 4.0;
  const std::vector<KindSums> sums = SumsByKind(model, at, information);
  const std::vector<bool> shifts = SensorsWithShifts(model);
  RigNoise noise = before;
  for (std::size_t s = 0; s < sums.size(); ++s) {
    for (std::size_t kind = 0; kind < kRigKinds; ++kind) {
      const bool is_shift = kind >= static_cast<std::size_t>(RigKind::kShiftOut);
      if (is_shift && !shifts[s]) {
        noise[s][kind] = kDecisionShift_m / kMinShift_m;
        continue;
      }
      const double prior = is_shift ? kPriorShifts : kPriorResiduals;
      const RigSum& sum = sums[s][kind];
      const double level = before[s][kind];
      noise[s][kind] = std::sqrt((prior + level * level * sum.squares) / (prior + sum.redundancy));
    }
  }
  return noise;
}

void ClearAbsentShifts(const RigModel& model, RigNoise& noise) {
  const std::vector<bool> shifts = SensorsWithShifts(model);
  for (std::size_t s = 0; s < noise.size(); ++s) {
    if (shifts[s]) continue;
    LevelOf(noise, s, RigKind::kShiftOut) = LevelOf(noise, s, RigKind::kShiftIn) = 1.0;
  }
}

bool IsSameLevels(const RigNoise& a, const RigNoise& b) {
  constexpr double kSame = 0.01;
  for (std::size_t s = 0; s < a.size(); ++s) {
    for (std::size_t kind = 0; kind < kRigKinds; ++kind) {
      if (std::abs(a[s][kind] - b[s][kind]) > kSame * b[s][kind]) return false;
    }
  }
  return true;
}

RigWeights WeightsFor(const RigModel& model, const RigState& state, const RigUnits& units,
                      const RigSelection& selection, const RigNoise& noise, double loss_scale) {
  RigWeights weights;
  for (std::size_t k = 0; k < units.size(); ++k) {
    const RigBlock& block = model.blocks[k];
    const double level = LevelOf(noise, block.sensor, block.kind);
    const double limit = level * UnitLimit(block.rows_per_unit, loss_scale);
    weights.blocks.emplace_back(units[k].size(), 0.0);
    for (std::size_t i = 0; i < units[k].size(); ++i) {
      if (!selection[k][i] || !std::isfinite(units[k][i])) continue;
      weights.blocks.back()[i] = SlopeRoot(units[k][i], limit) / level;
    }
  }
  for (std::size_t i = 0; i < model.placements.size(); ++i) {
    weights.shifts_by_m.emplace_back();
    for (std::size_t s = 0; s < model.placements[i].shifts.size(); ++s) {
      const RigShift& shift = model.placements[i].shifts[s];
      Vector6d by;
      for (int k = 0; k < 6; ++k) {
        const RigKind kind = ShiftKind(static_cast<std::size_t>(k));
        by[k] = 1.0 / (shift.sigma_m * LevelOf(noise, shift.sensor, kind));
      }
      const double norm = by.cwiseProduct(ShiftAt(model, state, i, s)).norm() / std::sqrt(6.0);
      const double limit = 1.0 + loss_scale * std::sqrt(0.5 / 6.0);
      weights.shifts_by_m.back().push_back(SlopeRoot(norm, limit) * by);
    }
  }
  return weights;
}

}  // namespace sextant
