// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "cli/commands.h"
#include "cli/load.h"
#include "cli/result_options.h"
#include "io/export/export_transform.h"
#include "io/text/text_file.h"

namespace sextant::cli {
namespace {

// A frame of that name has its x axis forward by ROS's rules, ours has it to the right.
constexpr const char* kUnnamedCamera = "camera";

ExportOptions FramesOf(const ExportCommandOptions& options, const CalibrationResult& result) {
  ExportOptions frames;
  if (result.camera_frame != kUnnamedCamera) frames.camera_frame = result.camera_frame;
  if (!options.camera_frame.empty()) frames.camera_frame = options.camera_frame;
  frames.lidar_frame = options.lidar_frame.empty() ? result.lidar_frame : options.lidar_frame;
  frames.lidar_is_parent = options.parent != "camera";
  return frames;
}

// A parent that a format cannot express would be silently ignored.
Expected<void> CheckParent(const ExportCommandOptions& options) {
  const auto& formats = ExportFormats();
  const auto format = std::find_if(formats.begin(), formats.end(),
                                   [&](const auto& one) { return options.format == one.name; });
  if (format == formats.end() || format->has_parent || options.parent.empty()) return {};
  return MakeError(
      ErrorCode::kInvalidOption,
      fmt::format("--parent: {} always holds cam_from_lidar; leave the option out", format->name));
}

}  // namespace

int RunExport(const ExportCommandOptions& options) {
  if (const Expected<void> ok = CheckParent(options); !ok) return Refuse("export", ok.error());
  const Expected<CalibrationResult> result = ReadCalibrationResult(options.result_path);
  if (!result) return Refuse("export", result.error());
  const ExportOptions frames = FramesOf(options, *result);
  const Expected<std::string> text = ExportTransform(options.format, *result, frames);
  if (!text) {
    return Refuse("export", {text.error().code,
                             fmt::format("{}: {}", options.result_path, text.error().message)});
  }
  if (options.out == "-") {
    fmt::print("{}", *text);
    return kAnswered;
  }
  if (const Expected<void> ok = WriteFileAtomically(options.out, *text); !ok) {
    return Refuse("export", ok.error());
  }
  fmt::print("{}: {} of {}\n", options.out, options.format, options.result_path);
  return kAnswered;
}

}  // namespace sextant::cli
