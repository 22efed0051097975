// SPDX-License-Identifier: Apache-2.0
#include "simulator/camera/image_effects.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "base/random.h"
#include "io/images/image_codec.h"

namespace sextant {
namespace {

struct Kernel {
  std::vector<double> weights;  // Weights from -radius to radius; their sum is 1.
  double variance = 0.0;
};

Kernel SampleGaussian(double sigma_px, int radius) {
  Kernel kernel;
  double sum = 0.0;
  for (int i = -radius; i <= radius; ++i) {
    kernel.weights.push_back(std::exp(-0.5 * (i / sigma_px) * (i / sigma_px)));
    sum += kernel.weights.back();
  }
  for (int i = -radius; i <= radius; ++i) {
    double& weight = kernel.weights[static_cast<std::size_t>(i + radius)];
    weight /= sum;
    kernel.variance += weight * i * i;
  }
  return kernel;
}

// A narrow Gaussian sampled at whole pixels has too small a variance (by a seventh at 0.5 px), so
// bisection finds the Gaussian whose samples have the requested variance.
std::vector<float> GaussianWeights(double sigma_px) {
  constexpr int kHalvings = 50;
  const int radius = static_cast<int>(std::ceil(4.0 * sigma_px)) + 1;
  double low = 0.0;
  double high = 2.0 * sigma_px + 1.0;
  for (int step = 0; step < kHalvings; ++step) {
    const double middle = 0.5 * (low + high);
    (SampleGaussian(middle, radius).variance < sigma_px * sigma_px ? low : high) = middle;
  }
  const Kernel kernel = SampleGaussian(high, radius);
  return {kernel.weights.begin(), kernel.weights.end()};
}

// Blurs along rows and transposes; applied twice it blurs in both directions.
cv::Mat BlurRowsAndTranspose(const cv::Mat& image, const std::vector<float>& weights) {
  const int radius = static_cast<int>(weights.size()) / 2;
  cv::Mat blurred(image.cols, image.rows, CV_32F);
  tbb::parallel_for(0, image.rows, [&](int row) {
    const float* in = image.ptr<float>(row);
    std::vector<float> padded(static_cast<std::size_t>(image.cols + 2 * radius));
    for (int i = 0; i < static_cast<int>(padded.size()); ++i) {
      padded[static_cast<std::size_t>(i)] = in[std::clamp(i - radius, 0, image.cols - 1)];
    }
    for (int column = 0; column < image.cols; ++column) {
      float sum = 0.0F;
      for (std::size_t i = 0; i < weights.size(); ++i) {
        sum += weights[i] * padded[static_cast<std::size_t>(column) + i];
      }
      blurred.at<float>(column, row) = sum;
    }
  });
  return blurred;
}

}  // namespace

cv::Mat BlurGaussian(const cv::Mat& image, double sigma_px) {
  const std::vector<float> weights = GaussianWeights(sigma_px);
  return BlurRowsAndTranspose(BlurRowsAndTranspose(image, weights), weights);
}

void Vignette(const Camera& camera, double share, cv::Mat& image) {
  const auto farther = [](double center, int size) {
    return std::max(std::abs(center + 0.5), std::abs(size - 0.5 - center));
  };
  const double radius =
      std::hypot(farther(camera.cx_px, image.cols), farther(camera.cy_px, image.rows));
  for (int row = 0; row < image.rows; ++row) {
    float* pixels = image.ptr<float>(row);
    for (int column = 0; column < image.cols; ++column) {
      const double x = (column - camera.cx_px) / radius;
      const double y = (row - camera.cy_px) / radius;
      pixels[column] *= static_cast<float>(1.0 - share * (x * x + y * y));
    }
  }
}

cv::Mat Expose(const cv::Mat& image, double grey_per_unit, const SensorNoise& noise) {
  const bool is_noisy = noise.read_sigma_grey > 0.0 || noise.shot_variance_grey > 0.0;
  const double read_variance = noise.read_sigma_grey * noise.read_sigma_grey;
  cv::Mat grey(image.size(), CV_8U);
  tbb::parallel_for(0, image.rows, [&](int row) {
    Random random(
        DeriveSeed(noise.seed, "image noise", noise.stream, static_cast<std::uint64_t>(row)));
    const float* in = image.ptr<float>(row);
    std::uint8_t* out = grey.ptr<std::uint8_t>(row);
    for (int column = 0; column < image.cols; ++column) {
      double level = grey_per_unit * static_cast<double>(in[column]);
      if (is_noisy) {
        level += std::sqrt(read_variance + noise.shot_variance_grey * level) * random.Normal();
      }
      out[column] = static_cast<std::uint8_t>(std::clamp(std::floor(level + 0.5), 0.0, 255.0));
    }
  });
  return grey;
}

Expected<cv::Mat> ThroughJpeg(const cv::Mat& image, int quality) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string bytes, EncodeImage(".jpg", image, quality));
  return DecodeImage(bytes, DecodedColor::kGrey);
}

}  // namespace sextant
