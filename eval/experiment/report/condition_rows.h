// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "eval/experiment/definition/experiment.h"
#include "eval/experiment/run/row_file.h"

namespace sextant {

/// Identifies the rows of one condition that are summarised together: those of one subject at one
/// step.
struct CellKey {
  int subject = 0;
  int index = 0;

  // NOLINTNEXTLINE(modernize-use-nullptr): false positive in the defaulted operator.
  friend auto operator<=>(const CellKey&, const CellKey&) = default;
};

/// The rows of one condition in a row file.
class ConditionRows {
 public:
  /// Requires that the reader's rows belong to the experiment. Both must outlive this object.
  static Expected<ConditionRows> Open(const Experiment& experiment, const RowFileReader& reader,
                                      std::size_t condition);

  /// In ascending order.
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

/// Reads some metrics of one condition's rows in repeated passes over the file, block by block, so
/// that memory does not grow with the number of trials. A small number of rows is cached in the
/// first pass.
class ColumnPasses {
 public:
  /// Some consecutive rows: the cell of each row, and one column per metric.
  struct Rows {
    std::vector<std::uint32_t> cells;
    std::vector<std::vector<double>> columns;
  };

  /// Requires wanted metrics; -1 means no metric, and its column stays empty. The rows must
  /// outlive this object.
  ColumnPasses(const ConditionRows& rows, const std::vector<int>& metrics);

  /// Visits all rows of the condition, trial by trial.
  Expected<void> Pass(const std::function<void(const Rows&)>& visit);

 private:
  Expected<Rows> Read(const RowBlockPlace& block) const;

  const ConditionRows* rows_;
  std::vector<int> columns_;  // Column numbers in the file; -1: none.
  bool keep_ = false;
  std::vector<Rows> kept_;
};

}  // namespace sextant
