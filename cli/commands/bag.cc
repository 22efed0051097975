// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/recordings.h"
#include "io/output/standard_output.h"

namespace sextant::cli {
namespace {

struct BagOptions {
  std::string path{};
  std::string extract_folder{};  ///< Empty: nothing is written.
  double tolerance_s = 0.05;
};

void Declare(BagOptions& options, Arguments& arguments) {
  arguments.Add("FILE", options.path,
                "Recording: .bag of ROS 1, .db3 of ROS 2 or its folder, or .mcap",
                {.required = true});
  arguments.Add("--extract", options.extract_folder,
                "Write scans (.pcd), images, camera_info (.yaml) and pairs.csv into this folder",
                {.writes = Writes::kFolder});
  arguments.Add("--tolerance", options.tolerance_s,
                "Maximum time between the scan and the image of a pair [s]",
                {.shows_default = true, .range = {{0.0, 3600.0}}});
}

int Run(const BagOptions& options) {
  const Expected<OpenedRecording> recording = OpenRecording(options.path, options.tolerance_s);
  if (!recording) return Refuse("bag", recording.error());
  Print("{}", recording->summary);
  if (options.extract_folder.empty()) return kAnswered;
  const Expected<int> files = recording->extract(options.extract_folder);
  if (!files) {
    const bool is_empty = files.error().code == ErrorCode::kMissingData;
    return Refuse("bag", files.error(), is_empty ? kNoAnswer : kWrongUse);
  }
  Print("{}", WroteLine(options.extract_folder, fmt::format("{} files", *files)));
  return kAnswered;
}

}  // namespace

Command BagCommand() {
  constexpr const char* kFooter =
      "A scan and an image are a pair if no other two unused ones are closer in time; each is "
      "used\n"
      "once.\n"
      "Examples:\n  sextant bag session.bag\n  sextant bag session.bag --extract session";
  return MakeCommand<BagOptions>("bag", "The topics of a recording, and its scans and images",
                                 kFooter, Declare, Run);
}

}  // namespace sextant::cli
