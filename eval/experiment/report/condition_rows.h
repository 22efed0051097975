// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "eval/experiment/definition/experiment.h"
#include "eval/experiment/run/row_file.h"

namespace sextant {

/// The rows of one condition that belong together: of one subject at one step.
struct CellKey {
  int subject = 0;
  int index = 0;

  // NOLINTNEXTLINE(modernize-use-nullptr): what the compiler writes for <=> looks like one.
  friend auto operator<=>(const CellKey&, const CellKey&) = default;
};

/// Which rows of the file are one condition's.
class ConditionRows {
 public:
  /// Requires the reader's rows to be the experiment's. Both must outlive this.
  static Expected<ConditionRows> Open(const Experiment& experiment, const RowFileReader& reader,
                                      std::size_t condition);

  /// Ascending.
  const std::vector<CellKey>& cells() const { return cells_; }

 private:
  friend class ColumnPasses;
  ConditionRows(const Experiment& experiment, const RowFileReader& reader)
      : experiment_(&experiment), reader_(&reader) {}

  const Experiment* experiment_;
  const RowFileReader* reader_;
  std::vector<RowBlockPlace> blocks_;
  std::vector<CellKey> cells_;
};

/// Some metrics of one condition's rows, read as often as asked: from the file, block by block, so
/// that memory does not grow with the trials; rows that are few are kept after the first pass.
class ColumnPasses {
 public:
  /// So many rows in their order: the cell of each, and a column a metric.
  struct Rows {
    std::vector<std::uint32_t> cells;
    std::vector<std::vector<double>> columns;
  };

  /// Requires wanted metrics; -1 stands for none, whose column stays empty. The rows must outlive
  /// this.
  ColumnPasses(const ConditionRows& rows, const std::vector<int>& metrics);

  /// All rows of the condition, trial by trial.
  Expected<void> Pass(const std::function<void(const Rows&)>& visit);

 private:
  Expected<Rows> Read(const RowBlockPlace& block) const;

  const ConditionRows* rows_;
  std::vector<int> columns_;  // In the file; -1: none.
  bool keep_ = false;
  std::vector<Rows> kept_;
};

}  // namespace sextant
