// SPDX-License-Identifier: Apache-2.0
#include "cli/report_file.h"

#include <utility>

#include "cli/progress.h"
#include "io/output/output_file.h"
#include "report/collect/utc_text.h"
#include "report/page/page_html.h"

namespace sextant::cli {

Expected<void> WriteReport(PageSource source, const std::filesystem::path& path) {
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
  return WriteFileAtomically(path, FormatPage(CollectPage(source)));
}

}  // namespace sextant::cli
