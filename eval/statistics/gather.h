// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "eval/statistics/rank_selector.h"
#include "eval/statistics/statistics.h"

namespace sextant {

/// sum(numerators) / sum(denominators) of pairs that pass once and are not kept.
class RatioSums {
 public:
  /// Exactly so many pairs will be added.
  explicit RatioSums(std::uint64_t count);

  void Add(double numerator, double denominator);

  double ratio() const { return numerator_ / denominator_; }
  /// BootstrapRatio of the pairs.
  Interval BootstrapInterval(std::uint64_t seed) const;

 private:
  std::uint64_t count_;
  std::uint64_t added_ = 0;
  double numerator_ = 0.0;
  double denominator_ = 0.0;
  std::vector<double> numerators_;  // Sums over runs of pairs, of which there are few.
  std::vector<double> denominators_;
};

/// Quantiles of numbers that pass kPasses times and are not kept.
class QuantileGatherer {
 public:
  static constexpr int kPasses = RankSelector::kPasses;
  struct Wanted {
    double q = 0.5;
    bool interval = false;
  };

  /// Exactly so many numbers will pass each time; at least one.
  QuantileGatherer(std::uint64_t count, const std::vector<Wanted>& wanted);

  void Add(double value) { selector_.Add(value); }
  void EndPass() { selector_.EndPass(); }

  /// As QuantileOfSorted and QuantileInterval have them. Requires kPasses, and a wanted q.
  double Quantile(double q) const;
  Interval IntervalOf(double q) const;

 private:
  std::uint64_t count_;
  RankSelector selector_;
};

}  // namespace sextant
