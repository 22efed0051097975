// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "calibrate/calibrate.h"
#include "geometry/board.h"
#include "report/page/page.h"

namespace sextant {

/// What a capture knows at one moment.
struct LivePageSource {
  const Calibration* calibration = nullptr;  ///< Null: no photo has a scan yet.
  std::vector<Board> boards{};
  std::vector<std::size_t> by_arrival{};  ///< Its views, the newest first.
  PageLive live{};
};

/// The report so far, with the next placement and what was just found at the top, and the newest
/// view selected. The photos and scans of the newest kMaxLivePhotos views are read.
ReportPage CollectLivePage(const LivePageSource& source);

inline constexpr std::size_t kMaxLivePhotos = 8;

}  // namespace sextant
