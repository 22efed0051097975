// SPDX-License-Identifier: Apache-2.0
#include "io/problems/feature_moments.h"
#include "io/problems/feature_table.h"
#include "io/problems/rig_yaml.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

// And the tables that a rig file may name.
SEXTANT_FUZZ_TARGET(rig_file, bytes) {
  CheckRoundTrip(ParseRigFile(bytes, "f"), ParseRigFile, FormatRigFile);
  const auto rows = ParseFeatureTable(bytes, "f");
  CheckOutcome(rows);
  if (!rows) return;
  const Board board{.id = 0, .top_right_m = 0.6, .right_bottom_m = 0.8};
  RigProblem problem{.boards = {board}};
  problem.sensors.push_back({.name = "left"});
  problem.sensors.push_back({.name = "top"});
  CheckOutcome(AddFeatures({{"f", *rows}}, {{0, {board, {{0.3, 0.4}, {-0.3, 0.4}}}}}, problem));
}

}  // namespace sextant::test
