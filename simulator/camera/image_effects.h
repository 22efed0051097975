// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "base/error.h"
#include "geometry/camera.h"

namespace sextant {

/// What a camera adds to the light that reaches its pixels.

/// Convolves a CV_32F image with samples of a Gaussian, cut beyond 4 sigma, that sum to 1 and have
/// the variance sigma_px^2; beyond the border the image goes on as its last pixel. Rows in
/// parallel, the same bits always.
cv::Mat BlurGaussian(const cv::Mat& image, double sigma_px);

/// Multiplies by 1 - share r^2 / R^2: r from the principal point, R the farthest image corner's.
void Vignette(const Camera& camera, double share, cv::Mat& image);

struct SensorNoise {
  double read_sigma_grey = 0.0;     ///< Of every pixel, whatever its light.
  double shot_variance_grey = 0.0;  ///< Variance per grey level of light: grey levels an electron.
  std::uint64_t seed = 0;    ///< Row r draws from DeriveSeed(seed, "image noise", stream, r).
  std::uint64_t stream = 0;  ///< Number of the camera.
};

/// CV_8U: round(grey_per_unit x image + noise), cut to 0..255. Noise is normal with the variance
/// read_sigma^2 + shot_variance x grey level.
cv::Mat Expose(const cv::Mat& image, double grey_per_unit, const SensorNoise& noise);

/// Through JPEG and back, quality 1 to 100. Error: kIo for what the codec says.
Expected<cv::Mat> ThroughJpeg(const cv::Mat& image, int quality);

}  // namespace sextant
