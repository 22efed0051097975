// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "geometry/camera.h"

namespace sextant {

/// Convolves a CV_32F image with a sampled Gaussian that is truncated beyond 4 sigma, normalised to
/// 1 and has the variance sigma_px^2; border pixels are replicated. Rows are processed in parallel,
/// with the same bits on any number of threads.
cv::Mat BlurGaussian(const cv::Mat& image, double sigma_px);

/// Multiplies by 1 - share r^2 / R^2, where r is the distance from the principal point and R that
/// of the farthest image corner.
void Vignette(const Camera& camera, double share, cv::Mat& image);

struct SensorNoise {
  double read_sigma_grey = 0.0;  ///< Read noise of every pixel, independent of its light.
  /// Shot noise: variance per grey level of light (grey levels per electron).
  double shot_variance_grey = 0.0;
  std::uint64_t seed = 0;    ///< Row r uses DeriveSeed(seed, "image noise", stream, r).
  std::uint64_t stream = 0;  ///< Number of the camera.
};

/// CV_8U image round(grey_per_unit x image + noise), clamped to 0..255. The noise is normal with
/// the variance read_sigma^2 + shot_variance x grey level.
cv::Mat Expose(const cv::Mat& image, double grey_per_unit, const SensorNoise& noise);

/// Encodes and decodes the image as JPEG, quality 1 to 100. Error: kIo with the codec's message.
Expected<cv::Mat> ThroughJpeg(const cv::Mat& image, int quality);

}  // namespace sextant
