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

/// The value of a statistic over the trials of one cell.
struct Figure {
  double value = std::numeric_limits<double>::quiet_NaN();  ///< NaN if no trial counts.
  std::optional<Interval> interval;  ///< 95 percent; Wilson's for rates, else bootstrap.
  std::uint64_t trials = 0;          ///< Number of trials that count.
  std::uint64_t all_trials = 0;      ///< With those without the value, or without an answer.
};

/// Computes a figure in several passes over the trials, which must be the same in the same order
/// each time and are not stored. NaN values do not count, except for rates, where they count as 0.
class FigureGatherer {
 public:
  /// `seed` is used by the bootstrap.
  FigureGatherer(const Statistic& statistic, std::uint64_t seed);

  /// True if no further pass is needed and figure() is final.
  bool done() const { return stage_ == Stage::kDone; }
  const Figure& figure() const { return figure_; }

  /// Adds one trial; `reference` and `where` are ignored if the statistic has none.
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
  std::uint64_t successes_ = 0;  // Used for rates.
  double mean_ = 0.0;            // Used for standard deviations.
  int rank_passes_ = 0;
  std::optional<RatioSums> sums_;              // Set in stages kSums and kDeviations.
  std::optional<QuantileGatherer> quantiles_;  // Set in stage kRanks.
};

/// The statistic for every cell of the condition, in the order of the cells.
Expected<std::vector<Figure>> ComputeFigures(const Statistic& statistic, const ConditionRows& rows,
                                             std::uint64_t seed);

}  // namespace sextant
