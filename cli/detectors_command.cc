// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "cli/commands.h"
#include "cli/load.h"
#include "eval/extractors/detector_study.h"
#include "eval/statistics/text_table.h"
#include "features/camera/tag_detector.h"

namespace sextant::cli {
namespace {

std::string DescribeEntry(const TagDetectorEntry& entry, bool markdown) {
  TextTable table({"option", "default", "unit", "meaning"}, TextTable::Columns::kWords);
  for (const OptionDoc& doc : entry.options) {
    // Choices stand as a|b, which a table of Markdown would take for columns.
    std::string unit = doc.unit;
    std::ranges::replace(unit, '|', ' ');
    table.AddRow({doc.name, doc.default_value, unit, doc.meaning});
  }
  return fmt::format("{}{}: {}, as in {}\n\n{}\n", markdown ? "### " : "", entry.name,
                     entry.summary, entry.example, markdown ? table.Markdown() : table.Plain());
}

}  // namespace

int RunDetectors(const DetectorStudyCommandOptions& options) {
  for (const TagDetectorEntry& entry : TagDetectorEntries()) {
    fmt::print("{}", DescribeEntry(entry, options.markdown));
  }
  if (options.trials == 0) return kAnswered;
  const Expected<std::vector<DetectorRow>> rows =
      StudyDetectors({.trials = options.trials, .seed = options.seed});
  if (!rows) return Refuse("detectors", rows.error());
  fmt::print(
      "{} rendered tags of 30 to 200 px, tilts to 60 deg, blur 0.7 px, noise of 3 grey "
      "levels:\n\n{}",
      options.trials, FormatDetectorStudy(*rows, options.markdown));
  return kAnswered;
}

}  // namespace sextant::cli
