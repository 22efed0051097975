// SPDX-License-Identifier: Apache-2.0
#include "features/camera/image_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace sextant {
namespace {

constexpr int kBlock_px = 16;
constexpr int kRowStep = 2;

// Sum of |a - 2 b + c| over every other row of a block; the columns to its left and right must be
// in the image.
int SumOfDifferences(const cv::Mat& grey, int left, int top) {
  std::array<std::int16_t, kBlock_px> sums{};
  for (int y = top; y < top + kBlock_px; y += kRowStep) {
    const std::uint8_t* row = grey.ptr<std::uint8_t>(y) + left;
    for (int i = 0; i < kBlock_px; ++i) {
      const int difference = row[i - 1] - 2 * row[i] + row[i + 1];
      sums[static_cast<std::size_t>(i)] = static_cast<std::int16_t>(
          sums[static_cast<std::size_t>(i)] + (difference < 0 ? -difference : difference));
    }
  }
  int sum = 0;
  for (const std::int16_t column : sums) sum += column;
  return sum;
}

}  // namespace

double EstimateNoiseGrey(const cv::Mat& grey) {
  std::vector<int> sums;
  for (int top = 0; top + kBlock_px <= grey.rows; top += kBlock_px) {
    for (int left = 1; left + kBlock_px < grey.cols; left += kBlock_px) {
      const int sum = SumOfDifferences(grey, left, top);
      if (sum > 0) sums.push_back(sum);
    }
  }
  if (sums.empty()) return 0.0;
  const auto quartile = sums.begin() + static_cast<std::ptrdiff_t>(sums.size() / 4);
  std::nth_element(sums.begin(), quartile, sums.end());
  // For white noise of sigma 1 the mean |difference| is sqrt(6) sqrt(2 / pi). The means of blocks
  // of 128 differences, which are correlated between neighbours, scatter by 9 percent, so their
  // lower quartile is 0.94 of that.
  const double of_unit_noise = 0.94 * std::sqrt(12.0 / std::acos(-1.0));
  constexpr int kDifferences = kBlock_px * kBlock_px / kRowStep;
  return *quartile / (kDifferences * of_unit_noise);
}

}  // namespace sextant
