// SPDX-License-Identifier: Apache-2.0
#include "features/camera/image_noise.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "base/random.h"
#include "support/grey_noise.h"

namespace sextant {
namespace {

using test::AddNoise;

// A gradient of brightness, and printed squares in half of the image.
cv::Mat Scene() {
  cv::Mat image(480, 480, CV_8U);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const bool is_black = x < 240 && (x / 9 + y / 9) % 2 == 0;
      image.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>((is_black ? 40 : 140) + y / 8);
    }
  }
  return image;
}

TEST(ImageNoise, IsEstimatedDespiteGradientsAndPrint) {
  for (const double sigma_grey : {1.0, 2.0, 3.0, 5.0}) {
    cv::Mat image = Scene();
    AddNoise(image, sigma_grey, 1);
    // Rounding to whole levels adds a variance of 1 / 12. The lower quartile of all blocks is the
    // median of those without print, 6 percent above their lower quartile.
    EXPECT_NEAR(EstimateNoiseGrey(image), std::sqrt(sigma_grey * sigma_grey + 1.0 / 12.0),
                0.09 * sigma_grey);
  }
}

TEST(ImageNoise, OfAWallIsExactToItsSamplingError) {
  cv::Mat image(720, 1280, CV_8U, cv::Scalar(128));
  AddNoise(image, 3.0, 2);
  // 3600 blocks: the quartile scatters by 0.2 percent; the constant is rounded to one percent.
  EXPECT_NEAR(EstimateNoiseGrey(image), std::sqrt(9.0 + 1.0 / 12.0), 0.03);
}

TEST(ImageNoise, OfAnExactImageIsZeroAndOverexposedPartsDoNotCount) {
  EXPECT_EQ(EstimateNoiseGrey(cv::Mat(100, 100, CV_8U, cv::Scalar(7))), 0.0);
  EXPECT_EQ(EstimateNoiseGrey(cv::Mat(9, 9, CV_8U, cv::Scalar(7))), 0.0);
  cv::Mat image(480, 480, CV_8U, cv::Scalar(128));
  AddNoise(image, 3.0, 3);
  image(cv::Rect(0, 0, 480, 240)) = 255;
  EXPECT_NEAR(EstimateNoiseGrey(image), 3.0, 0.1);
}

}  // namespace
}  // namespace sextant
