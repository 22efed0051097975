// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/options.h"
#include "solvers/core/registry.h"
#include "solvers/refine/refine_ceres.h"

namespace sextant {

enum class RefineOn { kAuto, k3d3d, k2d3d, kBoth };

inline bool Uses3d3d(RefineOn on) { return on == RefineOn::k3d3d || on == RefineOn::kBoth; }
inline bool Uses2d3d(RefineOn on) { return on == RefineOn::k2d3d || on == RefineOn::kBoth; }

/// The options of `refine`.
struct RefineOptions {
  RefineOn on = RefineOn::kAuto;
  LossKind loss = LossKind::kNone;
  double loss_scale = 0.0;
  double loss_shape = RobustLoss{}.shape;
  unsigned intrinsics = 0;  ///< IntrinsicKind bits.
  int max_iterations = RefineLimits{}.max_iterations;
  double step_tolerance = RefineLimits{}.step_tolerance;
  double sigma_m = 0.0;  ///< For pairs that state none; 0: estimated, see refine_noise.h.
  double sigma_px = 0.0;

  RobustLoss Loss() const;
};

OptionSet<RefineOptions> RefineOptionSet();

/// The options of a `refine` with `on` resolved. Errors: kInvalidOption, also for options that
/// contradict the inner solver or each other.
Expected<RefineOptions> ParseRefineOptions(const SolverArguments& arguments);

}  // namespace sextant
