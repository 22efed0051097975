// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "eval/extractors/extractor_study.h"

namespace sextant {

inline constexpr int kRolls =
    12;  ///< Every 15 degrees of half a turn; the other half looks the same.
inline constexpr int kRollRingsDue = 4;      ///< Rings that must cross a board for it to be due,
inline constexpr int kRollReturnsDue = 300;  ///< or returns, for a sensor without rings.

/// Boards at every roll.
struct RollStudyOptions {
  std::vector<std::string> models{};  ///< Empty: all models of the simulator.
  int trials = 20;                    ///< Scans of one board for each model and roll.
  double min_side_m = 0.45;           ///< Sides are drawn uniformly from here...
  double max_side_m = 1.4;            ///< ...to here.
  BoardHolding holding = BoardHolding::kHung;
  std::uint64_t seed = 1;
};

struct RollStudyRow {
  std::string model{};
  std::array<int, kRolls> due{};
  std::array<int, kRolls> found{};  ///< Due and with each corner within a sixth of a side.
  int misplaced = 0;                ///< Found elsewhere.
  /// Mean of e^T C^-1 e / 3 over the corners by `rectangle`: at level boards (roll 0 and 90
  /// degrees), and at all others.
  double level_nees = 0.0;
  double other_nees = 0.0;
};

/// One row per model. The same seed gives the same figures on any number of threads. Errors:
/// kUnknownName; those of SimulateScan.
Expected<std::vector<RollStudyRow>> StudyRolls(const RollStudyOptions& options);

/// Found boards in percent of those due, by roll, as a table.
std::string FormatRollStudy(const std::vector<RollStudyRow>& rows, bool markdown);

}  // namespace sextant
