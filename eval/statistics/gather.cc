// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics/gather.h"

#include <algorithm>
#include <cassert>

namespace sextant {
namespace {

std::vector<std::uint64_t> RanksOf(std::uint64_t count,
                                   const std::vector<QuantileGatherer::Wanted>& wanted) {
  std::vector<std::uint64_t> ranks;
  for (const auto& [q, interval] : wanted) {
    const QuantilePlace place = PlaceOfQuantile(count, q);
    ranks.insert(ranks.end(), {place.below, place.above});
    if (!interval) continue;
    const RankInterval ends = QuantileIntervalRanks(count, q);
    ranks.insert(ranks.end(), {ends.low, ends.high});
  }
  return ranks;
}

}  // namespace

RatioSums::RatioSums(std::uint64_t count)
    : count_(count),
      numerators_(std::min(count, kBootstrapRuns), 0.0),
      denominators_(numerators_.size(), 0.0) {}

void RatioSums::Add(double numerator, double denominator) {
  assert(added_ < count_);
  numerator_ += numerator;
  denominator_ += denominator;
  const std::uint64_t run = added_++ * numerators_.size() / count_;
  numerators_[run] += numerator;
  denominators_[run] += denominator;
}

Interval RatioSums::BootstrapInterval(std::uint64_t seed) const {
  return BootstrapRatio(numerators_, denominators_, seed);
}

QuantileGatherer::QuantileGatherer(std::uint64_t count, const std::vector<Wanted>& wanted)
    : count_(count), selector_(RanksOf(count, wanted)) {}

double QuantileGatherer::Quantile(double q) const {
  const QuantilePlace place = PlaceOfQuantile(count_, q);
  return place.Between(selector_.ValueAt(place.below), selector_.ValueAt(place.above));
}

Interval QuantileGatherer::IntervalOf(double q) const {
  const RankInterval ends = QuantileIntervalRanks(count_, q);
  return {selector_.ValueAt(ends.low), selector_.ValueAt(ends.high)};
}

}  // namespace sextant
