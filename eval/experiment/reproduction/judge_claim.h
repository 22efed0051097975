// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "eval/experiment/report/condition_rows.h"
#include "eval/experiment/report/figure.h"
#include "eval/experiment/reproduction/claims.h"

namespace sextant {

enum class Verdict { kReproduced, kDirection, kRefuted, kUndecided, kNotTestable };

/// "reproduced" and so on, as printed on the page.
std::string_view ToString(Verdict verdict);

/// A claim with the result of its test.
struct JudgedClaim {
  Claim claim{};
  std::string ours{};  ///< One or two figures with their intervals.
  Verdict verdict = Verdict::kNotTestable;
  std::string remark{};
};

/// An experiment and its rows.
struct RowsOf {
  const Experiment* experiment = nullptr;
  const RowFileReader* reader = nullptr;
  bool is_recording = false;  ///< Its one trial is a recording, not a random draw.
};

/// Tests the claim by its rule; see ClaimRule. `rows` by name of the experiment. Not testable if
/// the experiment was not run (real data absent); undecided from fewer trials than give an
/// interval. Errors: kUnknownName for a condition, subject, step or statistic that the experiment
/// does not have; those of reading rows.
Expected<JudgedClaim> JudgeClaim(const Claim& claim, const std::map<std::string, RowsOf>& rows);

/// Applies the claim's rule to intervals; for kDraw, `ours` is the central 95 percent of the
/// trials.
Verdict VerdictOf(const Claim& claim, const Interval& ours, const std::optional<Interval>& than);

}  // namespace sextant
