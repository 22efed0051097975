// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/load.h"
#include "eval/extractors/extractor_study.h"
#include "eval/statistics/text_table.h"
#include "features/lidar/corner_extractor.h"

namespace sextant::cli {

int RunExtractors(const ExtractorStudyCommandOptions& options) {
  TextTable table({"extractor", "corners by"}, TextTable::Columns::kWords);
  for (const CornerExtractorInfo& info : CornerExtractors()) {
    table.AddRow({info.name, info.summary});
  }
  fmt::print("{}", options.markdown ? table.Markdown() : table.Plain());
  if (options.trials == 0) return kAnswered;
  ExtractorStudyOptions study;
  study.models = options.models;
  study.trials = study.placements = study.rooms = options.trials;
  study.holding = options.holding;
  study.seed = options.seed;
  const Expected<std::vector<ExtractorStudyRow>> rows = StudyExtractors(study);
  if (!rows) return Refuse("extractors", rows.error());
  fmt::print(
      "\nRange sigma 1 cm, spots, mixed and lost returns as each model has them, each {} scans: of "
      "two 48 cm boards 1.2 to 4.2 m away in a room (due: with {} rings or, without rings, {} "
      "returns on it), of rooms without a board, and of the two boards 1.8 m away for the "
      "corners:\n\n{}",
      options.trials, kRingsDue, kReturnsDue, FormatExtractorStudy(*rows, options.markdown));
  return kAnswered;
}

}  // namespace sextant::cli
