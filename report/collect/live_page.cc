// SPDX-License-Identifier: Apache-2.0
#include "report/collect/live_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>

#include "base/version.h"
#include "report/collect/collect_page.h"
#include "report/collect/frame_source.h"
#include "report/collect/no_pose.h"

namespace sextant {
namespace {

// Where to begin, as no placement can be computed without a pose.
PageNext FirstPlacement(const std::vector<Board>& boards) {
  std::string names;
  for (const Board& board : boards) {
    names += fmt::format("{}{} ({:.2f} x {:.2f} m)", names.empty() ? "" : ", ", board.id,
                         board.top_right_m, board.right_bottom_m);
  }
  return {.sentences = {
              fmt::format("Hold the board {} 1.2 to 3 m away, where both sensors see all of it, "
                          "slanted, with a corner up, and at rest.",
                          names),
              "Take a photo and a scan of it; then do the same at another place. From the first "
              "pose on, this page computes the place that improves the answer most."}};
}

FrameSource FramesOfViews(std::vector<std::size_t> chosen) {
  return [chosen = std::move(chosen)](const std::vector<ResultView>& views,
                                      const FrameVisitor& visit) {
    std::vector<ResultView> some;
    for (const std::size_t i : chosen) some.push_back(views[i]);
    return FramesOfFiles({})(
        some, [&](std::size_t k, const Expected<Frame>& frame) { visit(chosen[k], frame); });
  };
}

ReportPage PageOf(const LivePageSource& source) {
  const Calibration& calibration = *source.calibration;
  std::vector<std::size_t> shown = source.by_arrival;
  shown.resize(std::min(shown.size(), kMaxLivePhotos));
  ReportPage page = CollectPage(
      {.result = calibration.result ? *calibration.result : ResultWithoutPose(calibration),
       .calibration = &calibration,
       .frames = FramesOfViews(shown),
       .compares_solvers = false});
  for (const std::size_t i : source.by_arrival) {
    if (!std::ranges::count(shown, i)) page.views[i].no_photo = "Shown in the report at the end.";
  }
  if (!calibration.result) page.next = FirstPlacement(source.boards);
  if (!shown.empty()) page.selected = shown.front();
  return page;
}

}  // namespace

ReportPage CollectLivePage(const LivePageSource& source) {
  ReportPage page;
  if (source.calibration != nullptr) {
    page = PageOf(source);
  } else {
    page.title = "camera and lidar";
    page.version = std::string(Version());
    page.verdict = {.word = "NOTHING YET",
                    .reason = "No photo and scan of one moment are in the folder",
                    .next = "Hold the board as below, and record both sensors"};
    page.next = FirstPlacement(source.boards);
  }
  page.kind = "Capture";
  page.live = source.live;
  return page;
}

}  // namespace sextant
