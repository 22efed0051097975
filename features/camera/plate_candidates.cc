// SPDX-License-Identifier: Apache-2.0
#include "features/camera/plate_candidates.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

constexpr double kSearched_px = 800.0;  // Longer side of the image in which regions are searched.
constexpr int kLevels = 24;
constexpr double kMinArea = 0.004;  // Relative to the image's.
constexpr double kMaxArea = 0.85;
constexpr double kMinSolidity = 0.93;  // Area relative to that of the convex hull.
constexpr double kMaxCurve = 0.006;    // Distance of a side from its chord, by the perimeter.
constexpr double kMinSideShare = 0.06;      // By the perimeter; shorter ones are rounded corners.
constexpr double kMinSine = 0.35;      // Between neighbouring sides: 20 degrees.
constexpr std::size_t kMaxCandidates = 200;

using Contour = std::vector<cv::Point>;

// Levels between nearly the darkest and nearly the brightest pixels, evenly spaced.
std::vector<double> LevelsOf(const cv::Mat& grey) {
  constexpr double kEnds = 0.02;
  std::array<double, 256> counts{};
  for (int y = 0; y < grey.rows; ++y) {
    const auto* row = grey.ptr<std::uint8_t>(y);
    for (int x = 0; x < grey.cols; ++x) counts[row[x]] += 1.0;
  }
  const auto quantile = [&](double share) {
    double sum = 0.0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      sum += counts[i];
      if (sum >= share * static_cast<double>(grey.total())) return static_cast<double>(i);
    }
    return 255.0;
  };
  const double low = quantile(kEnds);
  const double high = quantile(1.0 - kEnds);
  std::vector<double> levels;
  for (int i = 1; i <= kLevels; ++i) levels.push_back(low + (high - low) * i / (kLevels + 1.0));
  return levels;
}

bool OnBorder(const cv::Point& a, const cv::Point& b, const cv::Size& size) {
  constexpr int kNear_px = 3;
  const auto both = [](int p, int q) { return p < kNear_px && q < kNear_px; };
  return both(a.x, b.x) || both(a.y, b.y) || both(size.width - 1 - a.x, size.width - 1 - b.x) ||
         both(size.height - 1 - a.y, size.height - 1 - b.y);
}

std::optional<PlateCandidate> CandidateOf(const Contour& contour, const cv::Size& size,
                                          double scale) {
  const double area = cv::contourArea(contour);
  const double whole = static_cast<double>(size.area());
  if (area < kMinArea * whole || area > kMaxArea * whole) return std::nullopt;
  Contour hull;
  cv::convexHull(contour, hull);
  if (area < kMinSolidity * cv::contourArea(hull)) return std::nullopt;
  const double perimeter = cv::arcLength(hull, true);
  Contour corners;
  cv::approxPolyDP(hull, corners, kMaxCurve * perimeter, true);
  if (cv::contourArea(corners, true) < 0.0) std::ranges::reverse(corners);
  PlateCandidate candidate;
  std::size_t count = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const cv::Point& a = corners[i];
    const cv::Point& b = corners[(i + 1) % corners.size()];
    if (OnBorder(a, b, size) || cv::norm(b - a) < kMinSideShare * perimeter) continue;
    if (count == candidate.sides.size()) return std::nullopt;
    const auto full = [scale](const cv::Point& p) {
      return Eigen::Vector2d((p.x + 0.5) / scale - 0.5, (p.y + 0.5) / scale - 0.5);
    };
    candidate.sides[count++] = {full(a), full(b)};
  }
  if (count != candidate.sides.size()) return std::nullopt;
  return candidate;
}

}  // namespace

std::vector<PlateCandidate> FindPlateCandidates(const cv::Mat& grey) {
  const double scale = std::min(1.0, kSearched_px / std::max(grey.cols, grey.rows));
  cv::Mat small;
  cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
  cv::GaussianBlur(small, small, {5, 5}, 0.0);
  std::vector<PlateCandidate> candidates;
  const cv::Mat thin = cv::getStructuringElement(cv::MORPH_ELLIPSE, {7, 7});
  for (const double level : LevelsOf(small)) {
    for (const bool is_brighter : {true, false}) {
      cv::Mat mask;
      cv::threshold(small, mask, level, 255.0,
                    is_brighter ? cv::THRESH_BINARY : cv::THRESH_BINARY_INV);
      // Cuts off fingers, ropes and other thin things that touch the plate.
      cv::morphologyEx(mask, mask, cv::MORPH_OPEN, thin);
      std::vector<Contour> contours;
      cv::findContours(mask, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
      for (const Contour& contour : contours) {
        std::optional<PlateCandidate> candidate = CandidateOf(contour, small.size(), scale);
        if (!candidate || candidates.size() == kMaxCandidates) continue;
        candidate->is_brighter = is_brighter;
        if (CornersOf(*candidate)) candidates.push_back(*candidate);
      }
    }
  }
  return candidates;
}

std::optional<Quad> CornersOf(const PlateCandidate& candidate) {
  Quad corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const PlateCandidate::Side& before = candidate.sides[(i + 3) % 4];
    const PlateCandidate::Side& side = candidate.sides[i];
    const Line2 a = LineThrough(before.from, before.to);
    const Line2 b = LineThrough(side.from, side.to);
    const double sine = a.normal.x() * b.normal.y() - a.normal.y() * b.normal.x();
    const std::optional<Eigen::Vector2d> corner = Intersect(a, b);
    // Clockwise, with y down, sides turn to the right: the sine is positive.
    if (!corner || sine < kMinSine) return std::nullopt;
    corners[i] = *corner;
  }
  return corners;
}

}  // namespace sextant
