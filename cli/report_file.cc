// SPDX-License-Identifier: Apache-2.0
#include "cli/report_file.h"

#include <utility>

#include "cli/progress.h"
#include "io/output/output_file.h"
#include "report/collect/no_pose.h"
#include "report/collect/utc_text.h"
#include "report/page/page_html.h"

namespace sextant::cli {

ReportPage CollectWithProgress(PageSource source) {
  source.written = TodayText();
  Progress progress;
  ProgressCounter counter(progress.Callback(), "report", source.result.views.size());
  if (source.frames) {
    source.frames = [frames = source.frames, &counter](const std::vector<ResultView>& views,
                                                       const FrameVisitor& visit) {
      return frames(views, [&](std::size_t view, const Expected<Frame>& frame) {
        visit(view, frame);
        counter.Step();
      });
    };
  }
  return CollectPage(source);
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
  const ReportPage page = CollectWithProgress(
      {.result = calibration.result ? *calibration.result : ResultWithoutPose(calibration),
       .calibration = &calibration,
       .frames = frames});
  return WritePage(page, path);
}

}  // namespace sextant::cli
