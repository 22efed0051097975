// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/report/trial_values.h"

namespace sextant {

Expected<std::vector<std::vector<double>>> TrialValuesOf(const ConditionRows& rows, int metric) {
  std::vector<std::vector<double>> values(rows.cells().size());
  ColumnPasses passes(rows, {metric});
  SEXTANT_RETURN_IF_ERROR(passes.Pass([&](const ColumnPasses::Rows& some) {
    for (std::size_t row = 0; row < some.cells.size(); ++row) {
      values[some.cells[row]].push_back(some.columns[0][row]);
    }
  }));
  return values;
}

}  // namespace sextant
