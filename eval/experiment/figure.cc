// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/figure.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.h"

namespace sextant {
namespace {

double Square(double x) { return x * x; }

double RatioOfSums(std::span<const double> numerators, std::span<const double> denominators) {
  return std::accumulate(numerators.begin(), numerators.end(), 0.0) /
         std::accumulate(denominators.begin(), denominators.end(), 0.0);
}

Figure RatioFigure(std::span<const double> numerators, std::span<const double> denominators,
                   std::uint64_t seed, bool root) {
  Interval interval = BootstrapRatio(numerators, denominators, seed);
  double value = RatioOfSums(numerators, denominators);
  if (root) {
    value = std::sqrt(value);
    interval = {std::sqrt(interval.low), std::sqrt(interval.high)};
  }
  return {value, interval, numerators.size()};
}

Figure MomentFigure(const Statistic& statistic, std::vector<double> values, std::uint64_t seed) {
  const std::vector<double> ones(values.size(), 1.0);
  if (statistic.kind == Statistic::Kind::kMean) return RatioFigure(values, ones, seed, false);
  const double centre = statistic.kind == Statistic::Kind::kSd ? RatioOfSums(values, ones) : 0.0;
  for (double& value : values) value = Square(value - centre);
  return RatioFigure(values, ones, seed, true);
}

Figure QuantileFigure(const Statistic& statistic, std::vector<double> values) {
  std::sort(values.begin(), values.end());
  Figure figure{.value = QuantileOfSorted(values, statistic.quantile),
                .interval = {},
                .trials = values.size()};
  // The bootstrap knows nothing beyond the sample's ends.
  if (statistic.quantile > 0.0 && statistic.quantile < 1.0) {
    figure.interval = QuantileInterval(values, statistic.quantile);
  }
  return figure;
}

Figure RateFigure(std::span<const double> values) {
  std::uint64_t successes = 0;
  for (const double value : values) successes += !std::isnan(value) && value != 0.0 ? 1U : 0U;
  return {static_cast<double>(successes) / static_cast<double>(values.size()),
          WilsonInterval(successes, values.size()), values.size()};
}

}  // namespace

Figure ComputeFigure(const Statistic& statistic, std::vector<double> values,
                     std::span<const double> reference, std::span<const double> where,
                     std::uint64_t seed) {
  const bool is_rate = statistic.kind == Statistic::Kind::kRate;
  std::vector<double> references;
  std::size_t count = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!where.empty() && (std::isnan(where[i]) || where[i] == 0.0)) continue;
    if (!is_rate && std::isnan(values[i])) continue;
    if (!reference.empty()) {
      if (std::isnan(reference[i])) continue;
      references.push_back(Square(reference[i]));
    }
    values[count++] = values[i];
  }
  values.resize(count);
  if (values.empty()) return {};
  switch (statistic.kind) {
    case Statistic::Kind::kQuantile:
      return QuantileFigure(statistic, std::move(values));
    case Statistic::Kind::kRate:
      return RateFigure(values);
    case Statistic::Kind::kEfficiency:
      for (double& value : values) value = Square(value);
      return RatioFigure(values, references, seed, true);
    default:
      return MomentFigure(statistic, std::move(values), seed);
  }
}

Expected<std::vector<Figure>> ComputeFigures(const Statistic& statistic, const ConditionRows& rows,
                                             std::uint64_t seed) {
  using Columns = std::vector<std::vector<double>>;
  const auto read = [&rows](int metric) -> Expected<Columns> {
    if (metric < 0) return Columns(rows.cells().size());
    return rows.Column(metric);
  };
  Expected<Columns> values = read(statistic.metric);
  if (!values) return tl::unexpected<Error>(values.error());
  const Expected<Columns> references = read(statistic.reference);
  if (!references) return tl::unexpected<Error>(references.error());
  const Expected<Columns> where = read(statistic.where);
  if (!where) return tl::unexpected<Error>(where.error());
  std::vector<Figure> figures(rows.cells().size());
  tbb::parallel_for(std::size_t{0}, figures.size(), [&](std::size_t cell) {
    figures[cell] = ComputeFigure(statistic, std::move((*values)[cell]), (*references)[cell],
                                  (*where)[cell], DeriveSeed(seed, statistic.text, 0, cell));
  });
  return figures;
}

}  // namespace sextant
