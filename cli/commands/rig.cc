// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <string_view>
#include <vector>

#include "base/text/path_text.h"
#include "calibrate/rig/calibrate_rig.h"
#include "cli/commands/commands.h"
#include "cli/progress.h"
#include "cli/rig_output.h"
#include "io/problems/rig_yaml.h"
#include "io/problems/transform_list.h"
#include "io/results/rig_result.h"
#include "io/text/text_file.h"

namespace sextant::cli {
namespace {

struct RigCommandOptions {
  std::string path{};
  std::string root{};  ///< Empty: the file's.
  std::string out_path = "rig.json";
  std::string json_path{};    ///< See Deliver.
  std::string report_path{};  ///< The report in HTML; empty: not written.
  bool estimate_time = false;
};

void Declare(RigCommandOptions& options, Arguments& arguments) {
  arguments.Add(
      "FILE", options.path,
      "Rig file (YAML): what each sensor measured of the boards; or rts.txt of the original\n"
      "package, the poses of several cameras and a LiDAR",
      {.required = true});
  arguments.Add("--root", options.root,
                "The sensor in whose frame poses are stated; default: the file's, or the first");
  arguments.Add(
      "--estimate-time", options.estimate_time,
      "Estimate how far each sensor's clock is ahead of the root's, from boards that move;\n"
      "the observations then have times");
  arguments.Add("--out", options.out_path, "Result file (JSON), for sextant export",
                {.shows_default = true, .writes = Writes::kFile});
  arguments.Add("--json", options.json_path,
                "Write the same to another file; - for standard output",
                {.writes = Writes::kFileOrStandardOutput});
  arguments.Add("--report", options.report_path,
                "Write a report for people who did not run this: one file of HTML",
                {.writes = Writes::kFile});
}

Expected<void> ChooseRoot(const std::string& name, RigFile& rig) {
  if (name.empty()) return {};
  std::string known;
  for (std::size_t s = 0; s < rig.problem.sensors.size(); ++s) {
    if (rig.problem.sensors[s].name == name) {
      rig.root = s;
      return {};
    }
    known += (known.empty() ? "" : ", ") + rig.problem.sensors[s].name;
  }
  return MakeError(ErrorCode::kUnknownName,
                   fmt::format("--root: no sensor '{}'; there are: {}", name, known));
}

// As rts.txt does.
bool BeginsWithMatrix(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  return begin != std::string_view::npos && !text.substr(begin).starts_with("---") &&
         std::string_view("+-.0123456789").find(text[begin]) != std::string_view::npos;
}

Expected<RigResult> ResultOfTransforms(const RigCommandOptions& options,
                                       const Expected<std::vector<Rigid3d>>& transforms) {
  if (!transforms) return tl::unexpected(transforms.error());
  if (!options.root.empty() || options.estimate_time) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("{} is for a rig file: {} has poses alone, in the frame of the LiDAR; leave it "
                    "out",
                    options.root.empty() ? "--estimate-time" : "--root", PathText(options.path)));
  }
  if (transforms->size() + 1 > kMaxRigSensors) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: sensors: expected at most {} items, got {}: the LiDAR, and a "
                                 "camera for each matrix",
                                 PathText(options.path), kMaxRigSensors, transforms->size() + 1));
  }
  return RigOfTransforms(*transforms);
}

Expected<RigResult> ResultFrom(const RigCommandOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(options.path));
  const Expected<std::vector<Rigid3d>> transforms = ParseTransformList(text, options.path);
  if (transforms || BeginsWithMatrix(text)) return ResultOfTransforms(options, transforms);
  SEXTANT_ASSIGN_OR_RETURN(RigFile rig, ParseRigFile(text, options.path));
  SEXTANT_RETURN_IF_ERROR(ChooseRoot(options.root, rig));
  Progress progress;
  return CalibrateRig(rig, options.estimate_time, progress.Callback());
}

int Run(const RigCommandOptions& options) {
  return DeliverRig("rig", ResultFrom(options),
                    {options.out_path, options.json_path, options.report_path});
}

}  // namespace

Command RigCommand() {
  constexpr const char* kFooter =
      "All sensors are solved together; then every pair alone, as a check. Cameras may have no "
      "view\n"
      "in common if others connect them. docs/rigs.md has an example, docs/formats.md the keys.\n"
      "Examples:\n"
      "  sextant rig rig.yaml\n"
      "  sextant rig rig.yaml --root lidar_top --out rig.json\n"
      "  sextant export rig.json --to ros2 --out rig.launch.py";
  return MakeCommand<RigCommandOptions>(
      "rig", "Poses of several cameras and LiDARs, from what they measured of boards", kFooter,
      Declare, Run);
}

}  // namespace sextant::cli
