// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

namespace sextant {

/// A 95 percent confidence interval.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// Wilson's score interval of a rate (Wilson 1927, JASA 22): all p that `successes` of `trials` do
/// not reject. Its width is positive even for 0 and for `trials` successes. Requires trials > 0.
Interval WilsonInterval(std::uint64_t successes, std::uint64_t trials);

/// Two-sided p of the sign test: how probable a difference of wins and losses as large as this is,
/// or a larger one, if both are equally probable. Exact up to 1000 of them, then by the normal
/// distribution. 1 without any.
double SignTest(std::uint64_t wins, std::uint64_t losses);

/// Position of the q-quantile among `count` ascending values, counted from 0 (type 7 of Hyndman and
/// Fan: position q (n - 1)).
struct QuantilePlace {
  std::uint64_t below = 0;
  std::uint64_t above = 0;
  double share = 0.0;  ///< Interpolation weight of `above`, in [0, 1).

  double Between(double value_below, double value_above) const {
    return share == 0.0 ? value_below : value_below + share * (value_above - value_below);
  }
};
QuantilePlace PlaceOfQuantile(std::uint64_t count, double q);

/// The q-quantile, linearly interpolated between order statistics. Requires at least one value, in
/// ascending order.
double QuantileOfSorted(std::span<const double> sorted, double q);

/// Ranks (from 0) of the values at the ends of QuantileInterval.
struct RankInterval {
  std::uint64_t low = 0;
  std::uint64_t high = 0;
};
RankInterval QuantileIntervalRanks(std::uint64_t count, double q);

/// Percentile bootstrap interval of the q-quantile in closed form, equal to the limit of infinitely
/// many resamples: the k-th of n values drawn with replacement is at most the j-th order statistic
/// of the sample with the probability that Binomial(n, j/n) is at least k (Efron 1979, section 3;
/// Hutson and Ernst 2000). The ends are where this probability reaches 2.5 and 97.5 percent.
Interval QuantileInterval(std::span<const double> sorted, double q);

/// Samples larger than this are resampled as this many means of runs of consecutive values.
inline constexpr std::uint64_t kBootstrapRuns = 200;

/// Percentile bootstrap interval of sum(numerators) / sum(denominators) from 1000 resamples of the
/// pairs, drawn with the seed. More than kBootstrapRuns pairs are resampled as means of runs of
/// consecutive pairs, which keeps the variance correct to half a percent. Requires the same number
/// of both, at least one.
Interval BootstrapRatio(std::span<const double> numerators, std::span<const double> denominators,
                        std::uint64_t seed);

}  // namespace sextant
