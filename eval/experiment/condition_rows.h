// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "eval/experiment/experiment.h"
#include "eval/experiment/row_file.h"

namespace sextant {

/// The rows of one condition that belong together: of one subject at one step.
struct CellKey {
  int subject = 0;
  int index = 0;

  friend auto operator<=>(const CellKey&, const CellKey&) = default;
};

/// The rows of one condition, read one metric at a time: 8 bytes a row are in memory.
class ConditionRows {
 public:
  /// Requires the reader's rows to be the experiment's. Both must outlive this.
  static Expected<ConditionRows> Open(const Experiment& experiment, const RowFileReader& reader,
                                      std::size_t condition);

  /// Ascending.
  const std::vector<CellKey>& cells() const { return cells_; }
  /// The values of a wanted metric by cell, in the order of trials.
  Expected<std::vector<std::vector<double>>> Column(int metric) const;

 private:
  ConditionRows(const Experiment& experiment, const RowFileReader& reader)
      : experiment_(&experiment), reader_(&reader) {}

  const Experiment* experiment_;
  const RowFileReader* reader_;
  std::vector<RowBlockPlace> blocks_;
  std::vector<CellKey> cells_;
};

}  // namespace sextant
