// SPDX-License-Identifier: Apache-2.0
#include "report/collect/check_page.h"

#include <fmt/core.h>

#include <cctype>
#include <optional>
#include <string>
#include <vector>

#include "base/units.h"
#include "eval/statistics/text_table.h"
#include "io/results/calibration_result.h"
#include "report/collect/frame_source.h"
#include "report/collect/page_inputs.h"
#include "report/collect/page_views.h"
#include "report/collect/pose_in_words.h"

namespace sextant {
namespace {

// The pairs in the form of views without boards, for the parts that a calibration has, too.
CalibrationResult AsResult(const CheckResult& check) {
  CalibrationResult result;
  result.version = check.version;
  result.camera = check.camera;
  result.cam_from_lidar = check.cam_from_lidar;
  for (std::size_t i = 0; i < check.pairs.size(); ++i) {
    const CheckedPair& pair = check.pairs[i];
    result.views.push_back({.view = static_cast<int>(i),
                            .name = pair.name,
                            .image_path = pair.image_path,
                            .cloud_path = pair.cloud_path});
  }
  return result;
}

PageVerdict CheckVerdictOf(const CheckResult& check) {
  PageVerdict verdict{.word = check.state, .reason = check.reason};
  for (char& c : verdict.word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  while (verdict.reason.ends_with('.')) verdict.reason.pop_back();
  if (check.state == "still valid") {
    verdict.tone = PageTone::kGood;
    if (check.is_certain) verdict.next = "Calibrate again where a change this small matters";
  } else if (check.state == "moved") {
    verdict.tone = PageTone::kBad;
    verdict.next = "Calibrate again; sextant refine-scene gives a start";
  } else {
    verdict.next = "Check again with more scenes that differ, with objects near and far";
  }
  return verdict;
}

std::string WithSigma(double value, const std::optional<double>& sigma, int decimals,
                      const char* unit) {
  return sigma ? fmt::format("{} ± {} {}", Fixed(value, decimals), Fixed(*sigma, decimals), unit)
               : fmt::format("{} {}", Fixed(value, decimals), unit);
}

std::vector<PageFigure> CheckFiguresOf(const CheckResult& check) {
  std::vector<PageFigure> figures;
  if (check.sigma) {
    figures.push_back(
        {"Rotation by", Fixed(kDegPerRad * check.change.head<3>().norm(), 2) + " deg",
         fmt::format("{} deg has to be seen", Fixed(kDegPerRad * check.detect_rad, 2))});
    figures.push_back({"Translation by", Fixed(1e3 * check.change.tail<3>().norm(), 0) + " mm",
                       fmt::format("{} mm has to be seen", Fixed(1e3 * check.detect_m, 0))});
  }
  figures.push_back(
      {"Photos with scans", std::to_string(check.pairs.size()), "those of one scene count once"});
  return figures;
}

PageSection ChangeOf(const CheckResult& check) {
  PageSection section{.id = "change", .title = "The change", .label = "Change"};
  if (!check.sigma) {
    section.sentences = {
        "No change is stated: either too little is known, or the measured pose is at the limit of "
        "what the search measures (2 deg, 0.1 m), where it may be a wrong optimum."};
    return section;
  }
  const auto row = [&](const char* name, int first, double scale, int decimals, const char* unit) {
    std::vector<std::string> cells = {name};
    for (int i = first; i < first + 3; ++i) {
      cells.push_back(
          WithSigma(scale * check.change(i), scale * (*check.sigma)(i), decimals, unit));
    }
    return cells;
  };
  section.table = {.header = {"Measured minus given pose, 1 sigma", "x", "y", "z"},
                   .rows = {row("rotation about", 0, kDegPerRad, 3, "deg"),
                            row("translation along", 3, 1e3, 1, "mm")},
                   .note = "In the axes of the camera (x right, y down, z forward)."};
  return section;
}

}  // namespace

ReportPage CollectCheckPage(const CheckResult& check, const std::filesystem::path& folder) {
  const CalibrationResult result = AsResult(check);
  ReportPage page{.kind = "Check of a calibration",
                  .title = check.pose_path,
                  .version = check.version,
                  .verdict = CheckVerdictOf(check),
                  .figures = CheckFiguresOf(check),
                  .transforms = {{.from = result.lidar_frame,
                                  .to = result.camera_frame,
                                  .to_from_from = check.cam_from_lidar,
                                  .in_words = PoseInWords(check.cam_from_lidar)}},
                  .sensors = PageSensorsOf(result),
                  .sections = {ChangeOf(check)},
                  .views = PageViewsOf(result, nullptr, FramesOfFiles(folder))};
  page.diagnostics = {check.reason};
  if (!check.read_as.empty()) {
    page.diagnostics.push_back(
        fmt::format("The pose was read as {}: {}.", check.read_as, check.read_by));
  }
  page.closing =
      "The transform below is the one that was checked. In each photo, returns must change colour "
      "where the photo has its edges; shifted edges show a calibration that is not valid.";
  page.inputs = InputsOf(result, nullptr, folder);
  return page;
}

}  // namespace sextant
