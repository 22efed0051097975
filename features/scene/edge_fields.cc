// SPDX-License-Identifier: Apache-2.0
#include "features/scene/edge_fields.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

struct Gradients {
  cv::Mat x;
  cv::Mat y;
  cv::Mat size;
};

Gradients GradientsOf(const cv::Mat& grey, double scale) {
  cv::Mat smooth;
  grey.convertTo(smooth, CV_32F);
  if (scale < 1.0) cv::resize(smooth, smooth, {}, scale, scale, cv::INTER_AREA);
  cv::GaussianBlur(smooth, smooth, {0, 0}, 1.0);
  Gradients g;
  cv::Sobel(smooth, g.x, CV_32F, 1, 0, 3, 1.0 / 8.0);
  cv::Sobel(smooth, g.y, CV_32F, 0, 1, 3, 1.0 / 8.0);
  cv::magnitude(g.x, g.y, g.size);
  return g;
}

// The average over a wide neighbourhood, from a smaller picture.
cv::Mat Surroundings(const cv::Mat& image) {
  cv::Mat small;
  cv::resize(image, small, {}, 0.125, 0.125, cv::INTER_AREA);
  cv::GaussianBlur(small, small, {0, 0}, 3.0);
  cv::Mat wide;
  cv::resize(small, wide, image.size(), 0.0, 0.0, cv::INTER_LINEAR);
  return wide;
}

bool IsRidge(const Gradients& g, int y, int x) {
  const float gx = g.x.at<float>(y, x);
  const float gy = g.y.at<float>(y, x);
  constexpr float kTan67 = 2.414F;
  int dx = 1;
  int dy = gx * gy > 0.0F ? 1 : -1;
  if (std::abs(gx) > kTan67 * std::abs(gy)) dy = 0;
  if (std::abs(gy) > kTan67 * std::abs(gx)) {
    dx = 0;
    dy = 1;
  }
  const float here = g.size.at<float>(y, x);
  return here >= g.size.at<float>(y - dy, x - dx) && here > g.size.at<float>(y + dy, x + dx);
}

// The maps of edges of each direction, before any blur.
std::array<cv::Mat, EdgeFields::kDirections> EdgeMaps(const Gradients& g) {
  constexpr float kNoise = 3.0F;  // Grey levels per pixel.
  constexpr float kMaxStrength = 1.5F;
  const cv::Mat around = Surroundings(g.size);
  std::array<cv::Mat, EdgeFields::kDirections> maps;
  for (cv::Mat& map : maps) map = cv::Mat::zeros(g.size.size(), CV_32F);
  for (int y = 1; y + 1 < g.size.rows; ++y) {
    for (int x = 1; x + 1 < g.size.cols; ++x) {
      const float size = g.size.at<float>(y, x);
      if (size <= 0.0F || !IsRidge(g, y, x)) continue;
      const float strength =
          std::min(kMaxStrength, size / (2.0F * around.at<float>(y, x) + kNoise));
      for (int k = 0; k < EdgeFields::kDirections; ++k) {
        const float angle = static_cast<float>(k) * std::numbers::pi_v<float> / 4.0F;
        const float cosine =
            (std::cos(angle) * g.x.at<float>(y, x) + std::sin(angle) * g.y.at<float>(y, x)) / size;
        maps[static_cast<std::size_t>(k)].at<float>(y, x) = strength * cosine * cosine;
      }
    }
  }
  return maps;
}

// Value and gradient by bilinear interpolation; the place is inside.
void AddSample(const cv::Mat& map, const Eigen::Vector2d& place, double weight,
               EdgeFields::Value& sum) {
  const int x = static_cast<int>(place.x());
  const int y = static_cast<int>(place.y());
  const double a = place.x() - x;
  const double b = place.y() - y;
  const float* top = map.ptr<float>(y) + x;
  const float* low = map.ptr<float>(y + 1) + x;
  const double left = (1.0 - b) * top[0] + b * low[0];
  const double right = (1.0 - b) * top[1] + b * low[1];
  sum.value += weight * ((1.0 - a) * left + a * right);
  sum.gradient.x() += weight * (right - left);
  sum.gradient.y() += weight * ((1.0 - a) * (low[0] - top[0]) + a * (low[1] - top[1]));
}

}  // namespace

EdgeFields::EdgeFields(const cv::Mat& grey, double scale) : scale_(scale) {
  std::array<cv::Mat, kDirections> maps = EdgeMaps(GradientsOf(grey, scale));
  for (int level = 0; level < kLevels; ++level) {
    for (std::size_t k = 0; k < kDirections; ++k) {
      cv::Mat& map = maps[k];
      if (level > 0) cv::resize(map, map, {}, 0.5, 0.5, cv::INTER_AREA);
      cv::Mat near;
      cv::Mat wide;
      cv::GaussianBlur(map, near, {0, 0}, kSigma_px);
      cv::GaussianBlur(map, wide, {0, 0}, 3.0 * kSigma_px);
      // A long straight edge gives about its strength, at every level.
      fields_[static_cast<std::size_t>(level)][k] =
          2.5 * kSigma_px * static_cast<double>(1 << level) * (near - wide);
    }
  }
}

std::optional<EdgeFields::Value> EdgeFields::At(int level, const Eigen::Vector2d& pixel,
                                                const Eigen::Vector2d& normal) const {
  const auto& maps = fields_[static_cast<std::size_t>(level)];
  const double factor = scale_ / static_cast<double>(1 << level);
  const Eigen::Vector2d place = (pixel.array() + 0.5) * factor - 0.5;
  const bool inside = place.x() >= 0.0 && place.y() >= 0.0 && place.x() < maps[0].cols - 1 &&
                      place.y() < maps[0].rows - 1;
  if (!inside) return std::nullopt;
  double turn = std::atan2(normal.y(), normal.x()) / (std::numbers::pi / kDirections);
  if (turn < 0.0) turn += kDirections;
  const int first = std::min(static_cast<int>(turn), kDirections - 1);
  const double share = turn - first;
  Value sum;
  AddSample(maps[static_cast<std::size_t>(first)], place, 1.0 - share, sum);
  AddSample(maps[static_cast<std::size_t>((first + 1) % kDirections)], place, share, sum);
  sum.gradient *= factor;
  return sum;
}

}  // namespace sextant
