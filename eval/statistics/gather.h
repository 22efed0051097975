// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "eval/statistics/rank_selector.h"
#include "eval/statistics/statistics.h"

namespace sextant {

/// Streaming sum(numerators) / sum(denominators) with a bootstrap interval; the pairs are not
/// stored.
class RatioSums {
 public:
  /// `count` is the exact number of pairs that will be added.
  explicit RatioSums(std::uint64_t count);

  void Add(double numerator, double denominator);

  double ratio() const { return numerator_ / denominator_; }
  /// The same interval as BootstrapRatio of the pairs.
  Interval BootstrapInterval(std::uint64_t seed) const;

 private:
  std::uint64_t count_;
  std::uint64_t added_ = 0;
  double numerator_ = 0.0;
  double denominator_ = 0.0;
  std::vector<double> numerators_;  // Sums over at most kBootstrapRuns runs of consecutive pairs.
  std::vector<double> denominators_;
};

/// Streaming quantiles: the values are presented kPasses times and not stored.
class QuantileGatherer {
 public:
  static constexpr int kPasses = RankSelector::kPasses;
  struct Wanted {
    double q = 0.5;
    bool interval = false;
  };

  /// `count` is the exact number of values in each pass; at least one.
  QuantileGatherer(std::uint64_t count, const std::vector<Wanted>& wanted);

  void Add(double value) { selector_.Add(value); }
  void EndPass() { selector_.EndPass(); }

  /// The same values as QuantileOfSorted and QuantileInterval. Requires kPasses passes and one of
  /// the wanted q.
  double Quantile(double q) const;
  Interval IntervalOf(double q) const;

 private:
  std::uint64_t count_;
  RankSelector selector_;
};

}  // namespace sextant
