// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "eval/metrics/metrics.h"

namespace sextant {

/// A statistic over the trials of one condition and subject, in the notation of experiment files:
/// `rms(rotation_deg)`, `p95(rotation_deg)`, `rate(success)`, `efficiency(rotation_deg,
/// bound_rotation_deg, where=fine)`.
struct Statistic {
  enum class Kind {
    kMean,
    kRms,
    kSd,
    kQuantile,
    kRate,        ///< Fraction of the trials in which the metric is not 0 (NaN counts as 0).
    kEfficiency,  ///< RMS of the first metric divided by the RMS of the second.
    kArea,        ///< Area under the share of trials below x, for x up to a limit; 0 to 1.
  };

  std::string text;   ///< Canonical spec.
  std::string label;  ///< Column heading.
  Kind kind = Kind::kMean;
  double quantile = 0.5;
  int metric = 0;
  int reference = -1;  ///< Second metric of an efficiency, else -1.
  double limit = 0.0;  ///< The threshold at which an area ends.
  int where = -1;      ///< Only trials in which this metric is not 0; -1: all.
  int decimals = 3;
};

/// Statistics: mean, rms, sd, min, median, max, p01 to p99, rate, efficiency, and auc(METRIC,
/// limit=X), the mean of max(0, 1 - metric / X) in which NaN counts as 0. Options: where=METRIC,
/// decimals=0..9. Errors: kParse, kUnknownName, kInvalidOption.
Expected<Statistic> ParseStatistic(const std::string& text, const std::vector<Metric>& metrics);

}  // namespace sextant
