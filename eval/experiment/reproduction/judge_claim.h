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

/// "reproduced" and so on, as the page says it.
std::string_view ToString(Verdict verdict);

/// A claim beside what the trials say.
struct JudgedClaim {
  Claim claim{};
  std::string ours{};  ///< Figure with interval, or two of them.
  Verdict verdict = Verdict::kNotTestable;
  std::string remark{};
};

/// Rows of the experiments by name.
struct RowsOf {
  const Experiment* experiment = nullptr;
  const RowFileReader* reader = nullptr;
};

/// By the claim's rule alone; see ClaimRule. Not testable where the experiment was not run (real
/// data absent). Errors: kUnknownName for a condition, subject, step or statistic that the
/// experiment does not have; those of reading rows.
Expected<JudgedClaim> JudgeClaim(const Claim& claim, const std::map<std::string, RowsOf>& rows);

/// The rule itself, on figures: `interval` is the middle 95 percent of the trials for kDraw.
Verdict VerdictOf(const Claim& claim, const Interval& ours, const std::optional<Interval>& than);

}  // namespace sextant
