// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace sextant::cli {

/// Maps the picture to the canvas: canvas = scale * pixel + offset. In both, (0, 0) is the centre
/// of the top-left pixel.
class MarkViewport {
 public:
  /// Shows the whole picture, centred; `bar` canvas pixels above and below it stay free.
  MarkViewport(int canvas_width, int canvas_height, int bar, int picture_width, int picture_height);

  void Fit();
  /// The point at `canvas` keeps its position. The scale stays between a quarter of the fit and 64
  /// canvas pixels per pixel.
  void ZoomAt(const Eigen::Vector2d& canvas, double factor);
  /// Moves the picture by `by` canvas pixels; a part of it stays in view.
  void Pan(const Eigen::Vector2d& by);

  Eigen::Vector2d ToCanvas(const Eigen::Vector2d& pixel) const { return scale_ * pixel + offset_; }
  Eigen::Vector2d ToPixel(const Eigen::Vector2d& canvas) const {
    return (canvas - offset_) / scale_;
  }
  double scale() const { return scale_; }
  const Eigen::Vector2d& offset() const { return offset_; }
  const Eigen::Vector2d& canvas_size() const { return canvas_; }
  Eigen::Vector2d canvas_center() const { return 0.5 * canvas_; }

 private:
  double FitScale() const;

  Eigen::Vector2d canvas_;
  double bar_;
  Eigen::Vector2d picture_;
  double scale_ = 1.0;
  Eigen::Vector2d offset_ = Eigen::Vector2d::Zero();
};

}  // namespace sextant::cli
