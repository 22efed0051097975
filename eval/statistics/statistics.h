// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace sextant {

/// What a figure could as well have been, at 95 percent confidence.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// Of a rate: the p that `successes` of `trials` do not reject (Wilson 1927, JASA 22). Never empty,
/// also for none and all. Requires trials > 0.
Interval WilsonInterval(std::uint64_t successes, std::uint64_t trials);

/// Where the q-quantile of so many values lies among them, ascending from 0 (Hyndman and Fan's type
/// 7: position q (n - 1)).
struct QuantilePlace {
  std::uint64_t below = 0;
  std::uint64_t above = 0;
  double share = 0.0;  ///< Of the way from one to the other.

  double Between(double value_below, double value_above) const {
    return share == 0.0 ? value_below : value_below + share * (value_above - value_below);
  }
};
QuantilePlace PlaceOfQuantile(std::uint64_t count, double q);

/// The q-quantile between the order statistics. Requires values, ascending.
double QuantileOfSorted(std::span<const double> sorted, double q);

/// Ranks of the values, from 0, at which QuantileInterval ends.
struct RankInterval {
  std::uint64_t low = 0;
  std::uint64_t high = 0;
};
RankInterval QuantileIntervalRanks(std::uint64_t count, double q);

/// The bootstrap's percentile interval of that quantile, as infinitely many resamples give it and
/// so without drawing any: of n values drawn with replacement, the k-th is at most the j-th of the
/// sample with the probability that Binomial(n, j/n) is at least k (Efron 1979, section 3; Hutson
/// and Ernst 2000). Ends where that reaches 2.5 and 97.5 percent.
Interval QuantileInterval(std::span<const double> sorted, double q);

/// More values than this are resampled as so many means of runs of them.
inline constexpr std::uint64_t kBootstrapRuns = 200;

/// The bootstrap's percentile interval of sum(numerators) / sum(denominators), of 1000 resamples of
/// the pairs, drawn from the seed. More than kBootstrapRuns pairs are resampled as means of runs of
/// them, which leaves the variance right to half a percent. Requires as many of both, at least one.
Interval BootstrapRatio(std::span<const double> numerators, std::span<const double> denominators,
                        std::uint64_t seed);

}  // namespace sextant
