// SPDX-License-Identifier: Apache-2.0
#include "simulator/camera/image_effects.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

namespace sextant::test {
namespace {

constexpr int kSide = 400;
constexpr double kCount = 1.0 * kSide * kSide;

cv::Mat Flat(double level) { return {kSide, kSide, CV_32F, cv::Scalar(level)}; }

double NormalBelow(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

Moments MomentsOf(const cv::Mat& image) {
  cv::Scalar mean;
  cv::Scalar sigma;
  cv::meanStdDev(image, mean, sigma);
  return {mean[0], sigma[0] * sigma[0]};
}

// Tolerances of five standard errors: a seed in a million fails.
TEST(Expose, HasTheSpecifiedMeanAndVariance) {
  for (const double level : {50.0, 100.3, 180.0}) {
    const SensorNoise noise{.read_sigma_grey = 3.0, .shot_variance_grey = 0.05, .seed = 11};
    const Moments moments = MomentsOf(Expose(Flat(level), 1.0, noise));
    const double variance = 9.0 + 0.05 * level + 1.0 / 12.0;  // 1/12 is due to rounding.
    EXPECT_NEAR(moments.mean, level, 5.0 * std::sqrt(variance / kCount));
    EXPECT_NEAR(moments.variance, variance, 5.0 * variance * std::sqrt(2.0 / kCount));
  }
}

TEST(Expose, NoiseIsNormalByChiSquare) {
  constexpr double kLevel = 100.3;
  constexpr double kSigma = 3.0;
  constexpr int kFirst = 92;
  constexpr int kLast = 109;
  const cv::Mat image = Expose(Flat(kLevel), 1.0, {.read_sigma_grey = kSigma, .seed = 12});
  std::vector<double> counts(kLast - kFirst + 1);
  for (const std::uint8_t level : cv::Mat_<std::uint8_t>(image)) {
    counts[static_cast<std::size_t>(std::min(std::max<int>(level, kFirst), kLast) - kFirst)] += 1.0;
  }
  double chi_square = 0.0;
  for (int level = kFirst; level <= kLast; ++level) {
    const double above = level == kLast ? 1.0 : NormalBelow((level + 0.5 - kLevel) / kSigma);
    const double below = level == kFirst ? 0.0 : NormalBelow((level - 0.5 - kLevel) / kSigma);
    const double expected = kCount * (above - below);
    const double difference = counts[static_cast<std::size_t>(level - kFirst)] - expected;
    chi_square += difference * difference / expected;
  }
  const double freedom = kLast - kFirst;
  EXPECT_NEAR(chi_square, freedom, 5.0 * std::sqrt(2.0 * freedom));
}

TEST(Expose, NoiseDiffersBetweenRowsAndCameras) {
  const SensorNoise noise{.read_sigma_grey = 3.0, .seed = 13};
  SensorNoise other = noise;
  other.stream = 1;
  const cv::Mat image = Expose(Flat(100.0), 1.0, noise);
  EXPECT_EQ(cv::countNonZero(image != Expose(Flat(100.0), 1.0, noise)), 0);
  EXPECT_GT(cv::countNonZero(image != Expose(Flat(100.0), 1.0, other)), 0.8 * kCount);
  EXPECT_GT(cv::countNonZero(image.row(0) != image.row(1)), 0.8 * kSide);
}

TEST(Expose, RoundsAndClamps) {
  const cv::Mat levels = (cv::Mat_<float>(1, 5) << -3.0F, 10.49F, 10.5F, 254.6F, 400.0F);
  const cv::Mat expected = (cv::Mat_<std::uint8_t>(1, 5) << 0, 10, 11, 255, 255);
  EXPECT_EQ(cv::countNonZero(Expose(levels, 1.0, {}) != expected), 0);
}

// A point becomes a Gaussian: checks its sum, centre and second moments.
TEST(BlurGaussian, HasTheSpecifiedVariance) {
  for (const double sigma : {0.2, 0.5, 0.7, 1.5}) {
    cv::Mat image = cv::Mat::zeros(41, 31, CV_32F);
    image.at<float>(20, 14) = 1.0F;
    const cv::Mat blurred = BlurGaussian(image, sigma);
    ASSERT_EQ(blurred.size(), image.size());
    double sum = 0.0;
    double xx = 0.0;
    double yy = 0.0;
    double xy = 0.0;
    for (int y = 0; y < blurred.rows; ++y) {
      for (int x = 0; x < blurred.cols; ++x) {
        const double share = static_cast<double>(blurred.at<float>(y, x));
        sum += share;
        xx += share * (x - 14) * (x - 14);
        yy += share * (y - 20) * (y - 20);
        xy += share * (x - 14) * (y - 20);
      }
    }
    EXPECT_NEAR(sum, 1.0, 1e-6);
    EXPECT_NEAR(xx, sigma * sigma, 1e-5);
    EXPECT_NEAR(yy, xx, 1e-5);
    EXPECT_NEAR(xy, 0.0, 1e-5);
  }
}

}  // namespace
}  // namespace sextant::test
