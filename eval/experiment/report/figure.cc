// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/report/figure.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace sextant {
namespace {

using StatisticKind = Statistic::Kind;

double Square(double x) { return x * x; }

bool IsNeither0NorNan(double value) { return !std::isnan(value) && value != 0.0; }

// The bootstrap gives no interval for the minimum and maximum.
bool HasInterval(double q) { return q > 0.0 && q < 1.0; }

}  // namespace

FigureGatherer::FigureGatherer(const Statistic& statistic, std::uint64_t seed)
    : statistic_(statistic), seed_(seed) {}

bool FigureGatherer::Counts(double value, double reference, double where) const {
  if (statistic_.where >= 0 && !IsNeither0NorNan(where)) return false;
  const bool counts_all =
      statistic_.kind == StatisticKind::kRate || statistic_.kind == StatisticKind::kArea;
  if (counts_all) return true;
  return !std::isnan(value) && !(statistic_.reference >= 0 && std::isnan(reference));
}

void FigureGatherer::Add(double value, double reference, double where) {
  if (stage_ == Stage::kCount) ++figure_.all_trials;
  if (!Counts(value, reference, where)) return;
  switch (stage_) {
    case Stage::kCount:
      ++figure_.trials;
      successes_ += IsNeither0NorNan(value) ? 1U : 0U;
      break;
    case Stage::kSums:
      if (statistic_.kind == StatisticKind::kArea) {
        sums_->Add(std::isnan(value) ? 0.0 : std::max(0.0, 1.0 - value / statistic_.limit), 1.0);
      } else if (statistic_.kind == StatisticKind::kMean || statistic_.kind == StatisticKind::kSd) {
        sums_->Add(value, 1.0);
      } else {
        sums_->Add(Square(value), statistic_.kind == StatisticKind::kRms ? 1.0 : Square(reference));
      }
      break;
    case Stage::kDeviations:
      sums_->Add(Square(value - mean_), 1.0);
      break;
    case Stage::kRanks:
      quantiles_->Add(value);
      break;
    case Stage::kDone:
      break;
  }
}

void FigureGatherer::EndPass() {
  switch (stage_) {
    case Stage::kCount:
      return EndCount();
    case Stage::kSums:
    case Stage::kDeviations:
      return EndSums();
    case Stage::kRanks:
      quantiles_->EndPass();
      if (++rank_passes_ == QuantileGatherer::kPasses) EndRanks();
      return;
    case Stage::kDone:
      return;
  }
}

void FigureGatherer::EndCount() {
  stage_ = Stage::kDone;
  if (figure_.trials == 0) return;
  if (statistic_.kind == StatisticKind::kRate) {
    figure_.value = static_cast<double>(successes_) / static_cast<double>(figure_.trials);
    figure_.interval = WilsonInterval(successes_, figure_.trials);
  } else if (statistic_.kind == StatisticKind::kQuantile) {
    const double q = statistic_.quantile;
    quantiles_.emplace(figure_.trials, std::vector<QuantileGatherer::Wanted>{{q, HasInterval(q)}});
    stage_ = Stage::kRanks;
  } else {
    sums_.emplace(figure_.trials);
    stage_ = Stage::kSums;
  }
}

void FigureGatherer::EndSums() {
  if (statistic_.kind == StatisticKind::kSd && stage_ == Stage::kSums) {
    mean_ = sums_->ratio();
    sums_.emplace(figure_.trials);
    stage_ = Stage::kDeviations;
    return;
  }
  figure_.value = sums_->ratio();
  figure_.interval = sums_->BootstrapInterval(seed_);
  if (statistic_.kind != StatisticKind::kMean && statistic_.kind != StatisticKind::kArea) {
    figure_.value = std::sqrt(figure_.value);
    figure_.interval = {std::sqrt(figure_.interval->low), std::sqrt(figure_.interval->high)};
  }
  sums_.reset();
  stage_ = Stage::kDone;
}

void FigureGatherer::EndRanks() {
  const double q = statistic_.quantile;
  figure_.value = quantiles_->Quantile(q);
  if (HasInterval(q)) figure_.interval = quantiles_->IntervalOf(q);
  quantiles_.reset();
  stage_ = Stage::kDone;
}

Expected<std::vector<Figure>> ComputeFigures(const Statistic& statistic, const ConditionRows& rows,
                                             std::uint64_t seed) {
  std::vector<FigureGatherer> gatherers;
  for (std::size_t cell = 0; cell < rows.cells().size(); ++cell) {
    gatherers.emplace_back(statistic, DeriveSeed(seed, statistic.text, 0, cell));
  }
  ColumnPasses passes(rows, {statistic.metric, statistic.reference, statistic.where});
  const auto visit = [&gatherers](const ColumnPasses::Rows& some) {
    const auto value = [](const std::vector<double>& column, std::size_t row) {
      return column.empty() ? 0.0 : column[row];
    };
    for (std::size_t row = 0; row < some.cells.size(); ++row) {
      gatherers[some.cells[row]].Add(some.columns[0][row], value(some.columns[1], row),
                                     value(some.columns[2], row));
    }
  };
  const auto is_done = [](const FigureGatherer& gatherer) { return gatherer.done(); };
  while (!std::all_of(gatherers.begin(), gatherers.end(), is_done)) {
    SEXTANT_RETURN_IF_ERROR(passes.Pass(visit));
    for (FigureGatherer& gatherer : gatherers) gatherer.EndPass();
  }
  std::vector<Figure> figures;
  for (const FigureGatherer& gatherer : gatherers) figures.push_back(gatherer.figure());
  return figures;
}

}  // namespace sextant
