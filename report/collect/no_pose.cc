// SPDX-License-Identifier: Apache-2.0
#include "report/collect/no_pose.h"

#include <algorithm>
#include <string_view>

#include "base/version.h"

namespace sextant {
namespace {

std::vector<std::string> LinesOf(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    line.remove_prefix(std::min(line.size(), line.find_first_not_of(' ')));
    if (!line.empty()) lines.emplace_back(line);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  }
  return lines;
}

std::string WhyLeftOut(const SessionView& view) {
  if (!view.seen) return LinesOf(view.seen.error().message).front();
  std::string reason;
  const auto add = [&reason](const std::string& text) {
    if (!text.empty()) reason += (reason.empty() ? "" : "; ") + text;
  };
  for (const CameraSighting& sighting : view.seen->in_image) add(sighting.left_out);
  for (const MissingBoard& missing : view.seen->missing) {
    add(missing.why.empty() ? "" : (missing.image ? "photo: " : "scan: ") + missing.why);
  }
  if (!reason.empty()) return reason;
  if (view.seen->in_image.empty()) return "no board was found in the photo";
  if (view.seen->in_scan.empty()) return "no board was found in the scan";
  return "both sensors saw a board, and no pose of the camera explains that in all views";
}

ResultView LeftOut(const SessionView& seen, std::size_t index) {
  return {.view = static_cast<int>(index),
          .name = seen.name,
          .image_path = seen.image_path,
          .cloud_path = seen.cloud_path,
          .image_time_s = seen.image_time_s,
          .cloud_time_s = seen.cloud_time_s,
          .kept = false,
          .reason = WhyLeftOut(seen)};
}

}  // namespace

CalibrationResult ResultWithoutPose(const Calibration& calibration) {
  const ObservedSession& observed = calibration.observed;
  CalibrationResult result;
  result.version = std::string(Version());
  result.camera = observed.camera;
  result.boards = observed.boards;
  for (std::size_t i = 0; i < observed.views.size(); ++i) {
    const SessionView& view = observed.views[i];
    if (view.seen && !result.lidar) result.lidar = view.seen->lidar;
    result.views.push_back(LeftOut(view, i));
  }
  std::vector<std::string> lines = LinesOf(calibration.result.error().message);
  if (lines.front()[0] >= 'a' && lines.front()[0] <= 'z') lines.front()[0] -= 'a' - 'A';
  result.verdict = ResultVerdict{
      .reason = lines.front(),
      .next = "Read below why each view was left out, correct that, and calibrate again"};
  result.warnings.assign(lines.begin() + 1, lines.end());
  result.warnings.insert(result.warnings.end(), calibration.warnings.begin(),
                         calibration.warnings.end());
  return result;
}

void DropWhatNeedsThePose(ReportPage& page) {
  page.transforms.clear();
  page.figures.clear();
  page.coverage.clear();
  page.next = {.sentences = {"No proposal: that needs a first pose."}};
  for (PageSensor& sensor : page.sensors) {
    if (sensor.is_camera) sensor.base_from_sensor.reset();
  }
  for (PageView& view : page.views) {
    for (PageBoard& board : view.boards) {
      board.by_camera.clear();
      board.lidar_in_px.clear();
    }
    if (view.photo) view.photo->dots.clear();
    if (view.scan) view.scan->colour.clear();
  }
}

}  // namespace sextant
