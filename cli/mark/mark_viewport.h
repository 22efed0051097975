// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace sextant::cli {

/// Which part of the picture a canvas shows: canvas = scale * pixel + offset. In both, (0, 0) is
/// the centre of the top-left pixel.
class MarkViewport {
 public:
  /// The whole picture, centred; above and below it `bar` canvas pixels are left free.
  MarkViewport(int canvas_width, int canvas_height, int bar, int picture_width, int picture_height);

  void Fit();
  /// Keeps what is under `canvas` where it is. Between a quarter of the fit and 64 canvas pixels a
  /// pixel.
  void ZoomAt(const Eigen::Vector2d& canvas, double factor);
  /// Moves the picture by that many canvas pixels; some of it stays in view.
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
