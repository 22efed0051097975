// SPDX-License-Identifier: Apache-2.0
#include "features/camera/grey_image.h"

#include <fmt/core.h>

#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

constexpr int kMinSide = 16;

cv::Mat ToEightBits(const cv::Mat& image) {
  double brightest = 0.0;
  cv::minMaxLoc(image.reshape(1), nullptr, &brightest);
  double scale = 1.0;
  while (brightest * scale >= 256.0) scale *= 0.5;
  cv::Mat bytes;
  image.convertTo(bytes, CV_8U, scale);
  return bytes;
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

}  // namespace sextant
