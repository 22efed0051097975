// SPDX-License-Identifier: Apache-2.0
#include "features/camera/grey_image.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

constexpr int kMinSide = 16;

// The upper eight of the bits that are used, as other programs take them: without rounding.
cv::Mat ToEightBits(const cv::Mat& image) {
  double brightest = 0.0;
  cv::minMaxLoc(image.reshape(1), nullptr, &brightest);
  int unused_bits = 0;
  while (std::ldexp(brightest, -unused_bits) >= 256.0) ++unused_bits;
  const cv::Mat flat = image.reshape(1);
  cv::Mat bytes(flat.size(), CV_8U);
  for (int y = 0; y < flat.rows; ++y) {
    const auto* from = flat.ptr<std::uint16_t>(y);
    auto* to = bytes.ptr<std::uint8_t>(y);
    for (int x = 0; x < flat.cols; ++x) to[x] = static_cast<std::uint8_t>(from[x] >> unused_bits);
  }
  return bytes.reshape(image.channels());
}

}  // namespace

Expected<cv::Mat> ToGrey(const cv::Mat& image) {
  if (image.cols < kMinSide || image.rows < kMinSide) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the image has {} x {} pixels, expected at least {} x {}",
                                 image.cols, image.rows, kMinSide, kMinSide));
  }
  const bool depth_known = image.depth() == CV_8U || image.depth() == CV_16U;
  const int channels = image.channels();
  if (!depth_known || (channels != 1 && channels != 3 && channels != 4)) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the image has {} channels of {} bytes, expected 1, 3 or 4 of 8 "
                                 "or 16 bits",
                                 channels, image.elemSize1()));
  }
  const cv::Mat bytes = image.depth() == CV_8U ? image : ToEightBits(image);
  if (channels == 1) return bytes;
  cv::Mat grey;
  cv::cvtColor(bytes, grey, channels == 3 ? cv::COLOR_BGR2GRAY : cv::COLOR_BGRA2GRAY);
  return grey;
}

double GreyAt(const cv::Mat& grey, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::floor(pixel.x()));
  const int y = static_cast<int>(std::floor(pixel.y()));
  if (x < 0 || y < 0 || x + 1 >= grey.cols || y + 1 >= grey.rows) return -1.0;
  const double fx = pixel.x() - x;
  const double fy = pixel.y() - y;
  const std::uint8_t* above = grey.ptr<std::uint8_t>(y) + x;
  const std::uint8_t* below = grey.ptr<std::uint8_t>(y + 1) + x;
  return (1.0 - fy) * ((1.0 - fx) * above[0] + fx * above[1]) +
         fy * ((1.0 - fx) * below[0] + fx * below[1]);
}

}  // namespace sextant
