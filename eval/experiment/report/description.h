// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "eval/statistics/gather.h"

namespace sextant {

/// What a summary says of the values of one metric: how many, moments and quantiles; gathered in
/// kPasses over the values, of which none is kept. NaN is missing.
class Description {
 public:
  static constexpr int kPasses = 1 + QuantileGatherer::kPasses;
  static constexpr std::array<double, 7> kQuantiles = {0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0};

  void Add(double value);
  void EndPass();

  /// After kPasses.
  std::uint64_t count() const { return count_; }
  std::uint64_t missing() const { return missing_; }
  /// The following require a value that is not missing.
  double mean() const;
  double sd() const;
  double rms() const;
  double Quantile(double q) const { return quantiles_->Quantile(q); }  ///< One of kQuantiles.
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
