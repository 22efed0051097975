// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "eval/statistics/gather.h"

namespace sextant {

/// Summary statistics of one metric: count, moments and quantiles, computed in kPasses passes over
/// the values without storing them. NaN counts as missing.
class Description {
 public:
  static constexpr int kPasses = 1 + QuantileGatherer::kPasses;
  static constexpr std::array<double, 7> kQuantiles = {0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0};

  void Add(double value);
  void EndPass();

  /// Valid after kPasses passes.
  std::uint64_t count() const { return count_; }
  std::uint64_t missing() const { return missing_; }
  /// The following require at least one value that is not missing.
  double mean() const;
  double sd() const;
  double rms() const;
  double Quantile(double q) const {
    return quantiles_->Quantile(q);
  }  ///< `q` is one of kQuantiles.
  Interval MedianInterval() const { return quantiles_->IntervalOf(0.5); }

 private:
  int pass_ = 0;
  std::uint64_t count_ = 0;
  std::uint64_t missing_ = 0;
  double sum_ = 0.0;
  double squares_ = 0.0;
  double deviations_ = 0.0;
  std::optional<QuantileGatherer> quantiles_;
};

}  // namespace sextant
