// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "cli/mark/mark_controller.h"
#include "report/projected_scan.h"

namespace sextant::cli {

/// Colours for ranges from the 2nd to the 98th percentile of a scan: near red, far blue.
class RangeColors {
 public:
  explicit RangeColors(const std::vector<ProjectedReturn>& returns);

  cv::Scalar Of(double range_m) const;
  double near_m() const { return near_m_; }
  double far_m() const { return far_m_; }

 private:
  double near_m_ = 0.0;
  double far_m_ = 1.0;
};

/// Draws the bars with the prompt and the keys, the legend of ranges, the warnings, and the help if
/// it is on.
void DrawMarkPanels(const MarkController& controller, bool has_photo, int bar_px, cv::Mat& canvas);

}  // namespace sextant::cli
