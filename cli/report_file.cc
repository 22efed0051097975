// SPDX-License-Identifier: Apache-2.0
#include "cli/report_file.h"

#include <utility>

#include "io/output/output_file.h"
#include "report/collect/no_pose.h"
#include "report/collect/utc_text.h"
#include "report/page/page_html.h"

namespace sextant::cli {

Expected<void> WriteReport(PageSource source, const std::filesystem::path& path) {
  source.written = TodayText();
  return WritePage(CollectPage(source), path);
}

Expected<void> WritePage(ReportPage page, const std::filesystem::path& path) {
  if (page.date.empty()) page.date = "report of " + TodayText();
  return WriteFileAtomically(path, FormatPage(page));
}

Expected<void> WriteCalibrationReport(const Calibration& calibration, double tolerance_s,
                                      const std::filesystem::path& path) {
  const FrameSource frames = [&](const std::vector<ResultView>&, const FrameVisitor& visit) {
    return VisitFrames(calibration.observed.session, tolerance_s, visit);
  };
  return WriteReport(
      {.result = calibration.result ? *calibration.result : ResultWithoutPose(calibration),
       .calibration = &calibration,
       .frames = frames},
      path);
}

}  // namespace sextant::cli
