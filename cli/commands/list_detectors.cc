// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "eval/extractors/detector_study.h"
#include "eval/statistics/text_table.h"
#include "features/camera/tag_detector.h"
#include "io/output/standard_output.h"

namespace sextant::cli {
namespace {

struct ListDetectorsOptions {
  int trials = 200;
  std::uint64_t seed = 1;
  bool markdown = false;
  GivenOptions given{};
};

void Declare(ListDetectorsOptions& options, Arguments& arguments) {
  arguments.Add("--trials", options.trials, "Rendered tags; 0: the options only",
                {.shows_default = true, .range = {{0, 1'000'000}}});
  arguments.Add("--seed", options.seed, "The same seed gives the same figures",
                {.shows_default = true});
  arguments.Add("--markdown", options.markdown, "As a page");
  arguments.ReportGiven(options.given);
}

std::string DescribeEntry(const TagDetectorEntry& entry, bool markdown) {
  TextTable table({"option", "default", "unit", "meaning"}, TextTable::Columns::kWords);
  for (const OptionDoc& doc : entry.options) {
    table.AddRow({doc.name, doc.default_value, doc.unit, doc.meaning});
  }
  return fmt::format("{}{}: {}, as in {}\n\n{}\n", markdown ? "### " : "", entry.name,
                     entry.summary, entry.example, markdown ? table.Markdown() : table.Plain());
}

int Run(const ListDetectorsOptions& options) {
  if (options.trials == 0) {
    const Expected<void> ok =
        RefuseGiven(options.given, {"--seed"}, "is for the tags of --trials, and there are none");
    if (!ok) return Refuse("list detectors", ok.error());
  }
  for (const TagDetectorEntry& entry : TagDetectorEntries()) {
    Print("{}", DescribeEntry(entry, options.markdown));
  }
  if (options.trials == 0) return kAnswered;
  const Expected<std::vector<DetectorRow>> rows =
      StudyDetectors({.trials = options.trials, .seed = options.seed});
  if (!rows) return Refuse("list detectors", rows.error());
  Print(
      "{} rendered tags of 30 to 200 px, tilts to 60 deg, blur 0.7 px, noise of 3 grey "
      "levels:\n\n{}",
      options.trials, FormatDetectorStudy(*rows, options.markdown));
  return kAnswered;
}

}  // namespace

Command ListDetectorsCommand() {
  return MakeCommand<ListDetectorsOptions>(
      "detectors", "The tag detectors with their options, and the accuracy of their corners",
      "Example:\n  sextant list detectors --trials 500", Declare, Run);
}

}  // namespace sextant::cli
