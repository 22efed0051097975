// SPDX-License-Identifier: Apache-2.0
#include "cli/mark/mark_viewport.h"

#include <algorithm>

namespace sextant::cli {

MarkViewport::MarkViewport(int canvas_width, int canvas_height, int bar, int picture_width,
                           int picture_height)
    : canvas_(canvas_width, canvas_height), bar_(bar), picture_(picture_width, picture_height) {
  Fit();
}

double MarkViewport::FitScale() const {
  const Eigen::Array2d room = canvas_ - Eigen::Vector2d(0.0, 2.0 * bar_);
  return (room / picture_.array()).minCoeff();
}

void MarkViewport::Fit() {
  scale_ = FitScale();
  const Eigen::Vector2d half = Eigen::Vector2d::Constant(0.5);
  offset_ = 0.5 * canvas_ - half - scale_ * (0.5 * picture_ - half);
}

void MarkViewport::ZoomAt(const Eigen::Vector2d& canvas, double factor) {
  const Eigen::Vector2d pixel = ToPixel(canvas);
  const double max_scale = std::max(64.0, FitScale());
  scale_ = std::clamp(scale_ * factor, 0.25 * FitScale(), max_scale);
  offset_ = canvas - scale_ * pixel;
  Pan(Eigen::Vector2d::Zero());
}

void MarkViewport::Pan(const Eigen::Vector2d& by) {
  const Eigen::Vector2d inset = 0.1 * canvas_;  // This much of the picture stays in view.
  const Eigen::Vector2d low = inset - scale_ * picture_;
  offset_ = (offset_ + by).cwiseMax(low).cwiseMin(canvas_ - inset);
}

}  // namespace sextant::cli
