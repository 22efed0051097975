// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "eval/extractors/extractor_study.h"
#include "eval/extractors/roll_study.h"
#include "eval/statistics/text_table.h"
#include "features/lidar/corner_extractor.h"
#include "io/output/standard_output.h"

namespace sextant::cli {
namespace {

constexpr int kTrialsPerRoll = 4;  // Scans at each of the rolls, as a part of --trials.

struct ListExtractorsOptions {
  std::vector<std::string> models{};  ///< Empty: all.
  std::string holding = "hung";
  int trials = 0;  ///< 0: the list of extractors only.
  std::uint64_t seed = 1;
  bool markdown = false;
  GivenOptions given{};
};

void Declare(ListExtractorsOptions& options, Arguments& arguments) {
  arguments.Add("--trials", options.trials, "Simulated scans of each kind; 0: the list only",
                {.shows_default = true, .range = {{0, 1'000'000}}});
  arguments.Add("--lidars", options.models, "Only these LiDARs of sextant list lidars",
                {.separator = ','});
  arguments.Add("--holding", options.holding,
                "How the boards are held: by nothing the LiDAR sees, on a stand, or in the hands",
                {.shows_default = true, .choices = {"hung", "stand", "hands"}});
  arguments.Add("--seed", options.seed, "The same seed gives the same figures",
                {.shows_default = true});
  arguments.Add("--markdown", options.markdown, "As a page");
  arguments.ReportGiven(options.given);
}

BoardHolding HoldingOf(const std::string& name) {
  if (name == "stand") return BoardHolding::kOnStand;
  return name == "hands" ? BoardHolding::kInHands : BoardHolding::kHung;
}

int Run(const ListExtractorsOptions& options) {
  if (options.trials == 0) {
    const Expected<void> ok = RefuseGiven(options.given, {"--lidars", "--holding", "--seed"},
                                          "is for the scans of --trials, and there are none");
    if (!ok) return Refuse("list extractors", ok.error());
  }
  TextTable table({"extractor", "corners by"}, TextTable::Columns::kWords);
  for (const CornerExtractorInfo& info : CornerExtractors()) {
    table.AddRow({info.name, info.summary});
  }
  Print("{}", options.markdown ? table.Markdown() : table.Plain());
  if (options.trials == 0) return kAnswered;
  ExtractorStudyOptions study;
  study.models = options.models;
  study.trials = study.placements = study.rooms = options.trials;
  study.holding = HoldingOf(options.holding);
  study.seed = options.seed;
  const Expected<std::vector<ExtractorStudyRow>> rows = StudyExtractors(study);
  if (!rows) return Refuse("list extractors", rows.error());
  Print(
      "\nRange sigma 1 cm; spots, mixed and lost returns as in each model. {} scans each of two "
      "48 cm boards 1.2 to 4.2 m away in a room (due: with {} rings or, without rings, {} returns "
      "on it), of rooms without a board, and of the two boards 1.8 m away for the corners:\n\n{}",
      options.trials, kRingsDue, kReturnsDue, FormatExtractorStudy(*rows, options.markdown));
  const Expected<std::vector<RollStudyRow>> rolls =
      StudyRolls({.models = options.models,
                  .trials = std::max(1, options.trials / kTrialsPerRoll),
                  .holding = study.holding,
                  .seed = options.seed});
  if (!rolls) return Refuse("list extractors", rolls.error());
  Print(
      "\nBoards with sides of 0.45 to 1.4 m, 1.5 to 4 m away, found by their roll (due: with {} "
      "rings or, without rings, {} returns on it):\n\n{}",
      kRollRingsDue, kRollReturnsDue, FormatRollStudy(*rolls, options.markdown));
  return kAnswered;
}

}  // namespace

Command ListExtractorsCommand() {
  return MakeCommand<ListExtractorsOptions>(
      "extractors", "The LiDAR corner extractors, and the accuracy of each with each LiDAR",
      "Example:\n  sextant list extractors --trials 200 --lidars vlp16,os1_64", Declare, Run);
}

}  // namespace sextant::cli
