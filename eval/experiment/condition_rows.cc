// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/condition_rows.h"

#include <algorithm>

#include "eval/experiment/run_trials.h"

namespace sextant {
namespace {

CellKey CellOf(std::uint64_t key) { return {SubjectOfKey(key), IndexOfKey(key)}; }

// The place of a cell; rows of one trial mostly go through the cells in order.
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

}  // namespace

Expected<ConditionRows> ConditionRows::Open(const Experiment& experiment,
                                            const RowFileReader& reader, std::size_t condition) {
  ConditionRows rows(experiment, reader);
  const std::uint64_t per_condition = BlocksPerCondition(experiment);
  for (const RowBlockPlace& block : reader.blocks()) {
    if (block.number / per_condition != condition) continue;
    rows.blocks_.push_back(block);
    const Expected<std::vector<std::uint64_t>> keys = reader.ReadKeys(block);
    if (!keys) return tl::unexpected<Error>(keys.error());
    for (const std::uint64_t key : *keys) rows.cells_.push_back(CellOf(key));
    std::sort(rows.cells_.begin(), rows.cells_.end());
    rows.cells_.erase(std::unique(rows.cells_.begin(), rows.cells_.end()), rows.cells_.end());
  }
  return rows;
}

Expected<std::vector<std::vector<double>>> ConditionRows::Column(int metric) const {
  std::size_t column = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(metric); ++i) {
    column += experiment_->wanted[i] ? 1U : 0U;
  }
  std::vector<std::vector<double>> by_cell(cells_.size());
  CellFinder finder(cells_);
  for (std::vector<double>& values : by_cell) values.reserve(experiment_->trials);
  for (const RowBlockPlace& block : blocks_) {
    const Expected<std::vector<std::uint64_t>> keys = reader_->ReadKeys(block);
    if (!keys) return tl::unexpected<Error>(keys.error());
    const Expected<std::vector<double>> values = reader_->ReadColumn(block, column);
    if (!values) return tl::unexpected<Error>(values.error());
    for (std::size_t i = 0; i < keys->size(); ++i) {
      by_cell[finder.Find(CellOf((*keys)[i]))].push_back((*values)[i]);
    }
  }
  return by_cell;
}

}  // namespace sextant
