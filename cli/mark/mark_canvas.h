// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>

#include "cli/mark/mark_controller.h"

namespace sextant::cli {

/// Height of the bars above and below the picture, with the prompt and the keys.
inline constexpr int kMarkBar_px = 34;

/// Draws the contents of the window of `sextant mark`. Caches the layers beneath the marks, which
/// change only with the view.
class MarkCanvas {
 public:
  /// `photo`: BGR, in the pixels of the scan's projection; empty if there is none.
  explicit MarkCanvas(cv::Mat photo) : photo_(std::move(photo)) {}

  /// BGR, of the viewport's canvas size.
  cv::Mat Draw(const MarkController& controller);

 private:
  void DrawBase(const MarkController& controller);

  cv::Mat photo_;
  cv::Mat base_;
  Eigen::Vector3d base_view_ =
      Eigen::Vector3d::Zero();  ///< Scale and offset with which it was drawn.
  MarkLayers base_layers_ = MarkLayers::kBoth;
};

}  // namespace sextant::cli
