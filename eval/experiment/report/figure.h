// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "eval/experiment/definition/statistic.h"
#include "eval/experiment/report/condition_rows.h"
#include "eval/statistics/gather.h"
#include "eval/statistics/statistics.h"

namespace sextant {

/// A statistic's value over the trials of one cell.
struct Figure {
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN where no trial counts.
  std::optional<Interval> interval;  ///< 95 percent: bootstrap, for rates Wilson's.
  std::uint64_t trials = 0;          ///< That count.
};

/// Gathers a figure from trials that pass by as often as it asks, the same in the same order each
/// time; none of them is kept. NaN values do not count, but for rates, where they count as 0.
class FigureGatherer {
 public:
  /// The seed is the bootstrap's.
  FigureGatherer(const Statistic& statistic, std::uint64_t seed);

  /// No further pass is wanted, and figure() is the figure.
  bool done() const { return stage_ == Stage::kDone; }
  const Figure& figure() const { return figure_; }

  /// One trial; `reference` and `where` are not looked at where the statistic has none.
  void Add(double value, double reference, double where);
  void EndPass();

 private:
  enum class Stage { kCount, kSums, kDeviations, kRanks, kDone };

  bool Counts(double value, double reference, double where) const;
  void EndCount();
  void EndSums();
  void EndRanks();

  Statistic statistic_;
  std::uint64_t seed_;
  Stage stage_ = Stage::kCount;
  Figure figure_;
  std::uint64_t successes_ = 0;  // Of a rate.
  double mean_ = 0.0;            // Of a standard deviation.
  int rank_passes_ = 0;
  std::optional<RatioSums> sums_;              // In kSums and kDeviations.
  std::optional<QuantileGatherer> quantiles_;  // In kRanks.
};

/// The statistic of every cell of the condition, in the order of its cells.
Expected<std::vector<Figure>> ComputeFigures(const Statistic& statistic, const ConditionRows& rows,
                                             std::uint64_t seed);

}  // namespace sextant
