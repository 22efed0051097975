// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "calibrate/match/assemble.h"
#include "calibrate/trust/trust.h"
#include "calibrate/trust/verdict.h"
#include "solvers/core/solver.h"

namespace sextant {

/// Everything that a calibration produced and the verdict is based on.
struct Evidence {
  std::span<const SessionView> views;
  const Assembly& assembly;
  const SolveReport& report;
  const Trust* trust = nullptr;         ///< Null: the views were not compared.
  std::optional<Rigid3d> rough_pose{};  ///< Given by the user: MatchSettings::initial.
};

/// The figures of the verdict. The accuracy is that of report.covariance.
VerdictFigures FiguresOf(const Evidence& evidence);

}  // namespace sextant
