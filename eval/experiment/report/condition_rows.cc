// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/report/condition_rows.h"

#include <algorithm>

#include "eval/experiment/run/run_trials.h"

namespace sextant {
namespace {

// Two megabytes per column.
constexpr std::uint64_t kMaxKeptRows = 1U << 18U;

CellKey CellOf(std::uint64_t key) { return {SubjectOfKey(key), IndexOfKey(key)}; }

// Finds the index of a cell; fast if successive rows have successive cells, as within one trial.
class CellFinder {
 public:
  explicit CellFinder(const std::vector<CellKey>& cells) : cells_(cells) {}

  std::size_t Find(const CellKey& cell) {
    last_ = last_ + 1 < cells_.size() ? last_ + 1 : 0;
    if (cells_[last_] != cell) {
      last_ = static_cast<std::size_t>(std::lower_bound(cells_.begin(), cells_.end(), cell) -
                                       cells_.begin());
    }
    return last_;
  }

 private:
  const std::vector<CellKey>& cells_;
  std::size_t last_ = 0;
};

// The column of a metric: rows contain only the wanted metrics.
int ColumnOf(const Experiment& experiment, int metric) {
  if (metric < 0) return -1;
  int column = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(metric); ++i) {
    column += experiment.wanted[i] ? 1 : 0;
  }
  return column;
}

}  // namespace

Expected<ConditionRows> ConditionRows::Open(const Experiment& experiment,
                                            const RowFileReader& reader, std::size_t condition) {
  ConditionRows rows(experiment, reader);
  const std::uint64_t per_condition = BlocksPerCondition(experiment);
  for (const RowBlockPlace& block : reader.blocks()) {
    if (block.number / per_condition != condition) continue;
    rows.blocks_.push_back(block);
    SEXTANT_ASSIGN_OR_RETURN(const std::vector<std::uint64_t> keys, reader.ReadKeys(block));
    for (const std::uint64_t key : keys) rows.cells_.push_back(CellOf(key));
    std::sort(rows.cells_.begin(), rows.cells_.end());
    rows.cells_.erase(std::unique(rows.cells_.begin(), rows.cells_.end()), rows.cells_.end());
  }
  return rows;
}

ColumnPasses::ColumnPasses(const ConditionRows& rows, const std::vector<int>& metrics)
    : rows_(&rows) {
  for (const int metric : metrics) columns_.push_back(ColumnOf(*rows.experiment_, metric));
  std::uint64_t count = 0;
  for (const RowBlockPlace& block : rows.blocks_) count += block.rows;
  keep_ = count <= kMaxKeptRows;
}

Expected<void> ColumnPasses::Pass(const std::function<void(const Rows&)>& visit) {
  for (std::size_t i = 0; i < rows_->blocks_.size(); ++i) {
    if (i < kept_.size()) {
      visit(kept_[i]);
      continue;
    }
    SEXTANT_ASSIGN_OR_RETURN(Rows rows, Read(rows_->blocks_[i]));
    visit(rows);
    if (keep_) kept_.push_back(std::move(rows));
  }
  return {};
}

Expected<ColumnPasses::Rows> ColumnPasses::Read(const RowBlockPlace& block) const {
  Rows rows;
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<std::uint64_t> keys, rows_->reader_->ReadKeys(block));
  CellFinder finder(rows_->cells_);
  for (const std::uint64_t key : keys)
    rows.cells.push_back(static_cast<std::uint32_t>(finder.Find(CellOf(key))));
  for (const int column : columns_) {
    rows.columns.emplace_back();
    if (column < 0) continue;
    SEXTANT_ASSIGN_OR_RETURN(std::vector<double> values,
                             rows_->reader_->ReadColumn(block, static_cast<std::size_t>(column)));
    rows.columns.back() = std::move(values);
  }
  return rows;
}

}  // namespace sextant
