// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace sextant {

/// How near to an edge of the image a pixel is, with the direction of the edge, at four scales.
///
/// Edges are maxima of the gradient along itself (Canny 1986), as strong as they stand out from
/// their surroundings. Each of four directions has a map of its own, in which an edge counts by the
/// squared cosine; the map is blurred, and less of a wider blur is taken off, so that textured
/// regions attract nothing. Level 0 is the finest; each next one is twice as wide.
class EdgeFields {
 public:
  static constexpr int kLevels = 4;
  static constexpr int kDirections = 4;

  /// `grey`: 8 bits. `scale`: of the pixels in which the fields are computed, to those of the
  /// image; at most 1. Time: about 0.1 s for a megapixel at that scale; memory 25 bytes for each
  /// such pixel.
  EdgeFields(const cv::Mat& grey, double scale);

  struct Value {
    double value = 0.0;
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();  ///< By the pixel.
  };
  /// At a pixel of the image, for an edge whose normal has this direction in the image. None
  /// outside of the image.
  std::optional<Value> At(int level, const Eigen::Vector2d& pixel,
                          const Eigen::Vector2d& normal) const;

  /// Standard deviation of the blur of a level [pixels of the image].
  double SigmaPx(int level) const { return kSigma_px * static_cast<double>(1 << level) / scale_; }

 private:
  static constexpr double kSigma_px = 1.5;
  double scale_;
  std::array<std::array<cv::Mat, kDirections>, kLevels> fields_;
};

}  // namespace sextant
