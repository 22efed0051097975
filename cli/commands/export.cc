// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "base/text/path_text.h"
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/pose_argument.h"
#include "io/export/export_rig.h"
#include "io/export/export_transform.h"
#include "io/output/output_file.h"
#include "io/output/standard_output.h"
#include "io/poses/pose_file.h"
#include "report/rig_text.h"

namespace sextant::cli {
namespace {

struct ExportCommandOptions {
  std::string result_path{};
  std::string pose_is{};
  std::string format{};
  std::string out = "-";
  std::string camera_frame{};  ///< Empty: the result's.
  std::string lidar_frame{};
  bool force = false;    ///< Also a result with the verdict NOT USABLE.
  std::string parent{};  ///< "lidar" or "camera"; empty: the LiDAR, if the format has a parent.
  std::vector<std::string> sensors{};  ///< Two of a rig; empty: all.
  GivenOptions given{};
};

std::string FormatsHelp() {
  std::string help;
  for (const ExportFormat& format : ExportFormats()) {
    help += fmt::format("{}{}: {}", help.empty() ? "" : "\n", format.name, format.summary);
  }
  return help;
}

std::vector<std::string> FormatNames() {
  std::vector<std::string> names;
  for (const ExportFormat& format : ExportFormats()) names.emplace_back(format.name);
  return names;
}

void Declare(ExportCommandOptions& options, Arguments& arguments) {
  arguments.Add("RESULT", options.result_path,
                std::string(kPoseHelp) + ",\nor rig.json of sextant rig", {.required = true});
  DeclarePoseIs(options.pose_is, arguments);
  arguments.Add("--to", options.format, FormatsHelp(), {.required = true, .offers = FormatNames()});
  arguments.Add("--out", options.out, "File to write; - for standard output",
                {.shows_default = true, .writes = Writes::kFileOrStandardOutput});
  arguments.Add("--lidar-frame", options.lidar_frame, "Default: the name in the result");
  arguments.Add(
      "--camera-frame", options.camera_frame,
      "The camera's optical frame (x right, y down); default: the name in the result, or\n"
      "camera_optical_frame");
  arguments.Add("--parent", options.parent,
                "lidar or camera: the frame in which the pose of the other is stated; default:\n"
                "lidar",
                {.choices = {"lidar", "camera"}});
  arguments.Add(
      "--sensors", options.sensors,
      "A B of a rig: A_from_B in any of the formats, A in the place of the camera; default:\n"
      "all sensors, in ros1, ros2, ros2_yaml, urdf or kitti",
      {.min_values = 2});
  arguments.Add("--force", options.force, "Export also a result with the verdict NOT USABLE");
  arguments.ReportGiven(options.given);
}

// By the conventions of ROS a frame of this name has x forward; ours has x to the right.
constexpr const char* kUnnamedCamera = "camera";

ExportOptions FramesOf(const ExportCommandOptions& options, const CalibrationResult& result) {
  ExportOptions frames;
  if (result.camera_frame != kUnnamedCamera) frames.camera_frame = result.camera_frame;
  if (!options.camera_frame.empty()) frames.camera_frame = options.camera_frame;
  frames.lidar_frame = options.lidar_frame.empty() ? result.lidar_frame : options.lidar_frame;
  frames.lidar_is_parent = options.parent != "camera";
  return frames;
}

// A parent or a frame that a format cannot express would be silently ignored.
Expected<void> CheckFormat(const ExportCommandOptions& options) {
  const auto& formats = ExportFormats();
  const auto format = std::find_if(formats.begin(), formats.end(),
                                   [&](const auto& one) { return options.format == one.name; });
  if (format == formats.end() || format->has_parent) return {};
  SEXTANT_RETURN_IF_ERROR(
      RefuseGiven(options.given, {"--parent"},
                  fmt::format("has no effect: {} always holds cam_from_lidar", format->name)));
  if (options.format == "matrix") return {};  // Its comment names the frames.
  return RefuseGiven(options.given, {"--lidar-frame", "--camera-frame"},
                     fmt::format("has no effect: {} has no names of frames", format->name));
}

Expected<void> CheckVerdict(const ExportCommandOptions& options, const CalibrationResult& result) {
  if (options.force || !result.verdict) return {};
  if (result.verdict->usability != Usability::kNotUsable) return {};
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("{} is NOT USABLE: {}. {}. To export it nevertheless, add --force",
                               options.result_path, result.verdict->reason, result.verdict->next));
}

Expected<void> CheckVerdict(const ExportCommandOptions& options, const RigResult& rig) {
  if (options.force || rig.refutations.empty()) return {};
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("{} is NOT USABLE: {}. To export it nevertheless, add --force",
                               options.result_path, rig.refutations[0]));
}

// Options of two frames would be silently ignored, too.
Expected<void> CheckWholeRig(const ExportCommandOptions& options) {
  return RefuseGiven(options.given, {"--lidar-frame", "--camera-frame", "--parent"},
                     "is for two sensors, which --sensors chooses, and all sensors of a rig have "
                     "the frames of their names, below the root");
}

Expected<std::string> ExportedRig(const ExportCommandOptions& options, const RigResult& rig) {
  SEXTANT_RETURN_IF_ERROR(RefuseGiven(options.given, {"--pose-is"},
                                      "has no effect on a rig's result, which states it"));
  if (options.sensors.empty()) {
    SEXTANT_RETURN_IF_ERROR(CheckWholeRig(options));
    for (const std::string& line : UnconnectedFindings(rig)) PrintError("warning: {}\n", line);
    return ExportRig(options.format, rig);
  }
  SEXTANT_ASSIGN_OR_RETURN(const CalibrationResult pair,
                           ResultOfPair(rig, options.sensors[0], options.sensors[1]));
  return ExportTransform(options.format, pair, FramesOf(options, pair));
}

Expected<std::string> ExportedPair(const ExportCommandOptions& options,
                                   const CalibrationResult& result) {
  if (options.sensors.empty()) {
    return ExportTransform(options.format, result, FramesOf(options, result));
  }
  return MakeError(ErrorCode::kInvalidOption,
                   "--sensors is for the result of a rig, which this is not");
}

int Write(const ExportCommandOptions& options, const Expected<std::string>& text) {
  if (!text) {
    return Refuse("export", {text.error().code,
                             fmt::format("{}: {}", options.result_path, text.error().message)});
  }
  if (options.out == "-") {
    Print("{}", *text);
    return kAnswered;
  }
  if (const Expected<void> ok = WriteFileAtomically(options.out, *text); !ok) {
    return Refuse("export", ok.error());
  }
  Print("{}", WroteLine(options.out,
                        fmt::format("{} of {}", options.format, PathText(options.result_path))));
  return kAnswered;
}

int RunOnRig(const ExportCommandOptions& options, const std::string& text) {
  const Expected<RigResult> rig = ParseRigResult(text, options.result_path);
  if (!rig) return Refuse("export", rig.error());
  if (const Expected<void> ok = CheckVerdict(options, *rig); !ok) {
    return Refuse("export", ok.error(), kNotUsable);
  }
  return Write(options, ExportedRig(options, *rig));
}

int Run(const ExportCommandOptions& options) {
  if (const Expected<void> ok = CheckFormat(options); !ok) return Refuse("export", ok.error());
  const Expected<PoseText> file = ReadPoseText(options.result_path);
  if (!file) return Refuse("export", file.error());
  if (file->name.empty() && IsRigResult(file->text)) return RunOnRig(options, file->text);
  const Expected<CalibrationResult> result =
      ResultOfText(*file, options.result_path, options.pose_is);
  if (!result) return Refuse("export", result.error());
  if (const Expected<void> ok = CheckVerdict(options, *result); !ok) {
    return Refuse("export", ok.error(), kNotUsable);
  }
  return Write(options, ExportedPair(options, *result));
}

}  // namespace

Command ExportCommand() {
  constexpr const char* kFooter =
      "ROS and URDF state the pose of the child in its parent: with the LiDAR as the parent that "
      "is\n"
      "lidar_from_camera, the inverse of cam_from_lidar. The other formats hold cam_from_lidar. "
      "Each\n"
      "file states which.\n"
      "Examples:\n"
      "  sextant export result.yaml --to ros2 --lidar-frame velodyne --camera-frame "
      "cam0_optical_frame --out extrinsic.launch.py\n"
      "  sextant export result.yaml --to kitti --out calib.txt\n"
      "  sextant export rig.json --to ros2 --out rig.launch.py\n"
      "  sextant export rig.json --sensors cam_left lidar_top --to matrix --out pose.txt";
  return MakeCommand<ExportCommandOptions>(
      "export", "A result in the format of another program: ROS, URDF, OpenCV, KITTI", kFooter,
      Declare, Run);
}

}  // namespace sextant::cli
