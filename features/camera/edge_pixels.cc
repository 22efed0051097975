// SPDX-License-Identifier: Apache-2.0
#include "features/camera/edge_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "base/simd.h"

namespace sextant {
namespace {

// An edge and the distance beyond it up to which the tag's surroundings are known.
struct Band {
  Line2 line;  ///< Its normal points outward.
  double outward_px = 0.0;
};

constexpr double kMinOutward_px = 0.75;
constexpr double kBlurOfMargin_px = 1.5;  ///< Reach of the blur from beyond the margin.

std::array<Band, 4> BandsOf(const Quad& corners, const TagPattern& pattern,
                            const EdgeRefineOptions& options) {
  const double turn = SignedArea(corners) > 0.0 ? 1.0 : -1.0;
  std::array<Band, 4> bands;
  for (std::size_t k = 0; k < 4; ++k) {
    Line2 line = LineThrough(corners[k], corners[(k + 1) % 4]);
    line.normal *= turn;
    line.offset *= turn;
    const double depth_px = line.offset - 0.5 * (line.normal.dot(corners[(k + 2) % 4]) +
                                                 line.normal.dot(corners[(k + 3) % 4]));
    const double known_cells = options.margin_cells + pattern.edge_first;
    const double known_px = known_cells * depth_px / pattern.edge_cells - kBlurOfMargin_px;
    bands[k] = {line, std::clamp(known_px, kMinOutward_px, options.band_px)};
  }
  return bands;
}

class Collector {
 public:
  Collector(const cv::Mat& grey, const Quad& corners, const TagPattern& pattern,
            const Undistortion& undistortion, const EdgeRefineOptions& options)
      : grey_(grey),
        corners_(corners),
        bands_(BandsOf(corners, pattern, options)),
        undistortion_(undistortion),
        options_(options) {}

  // Steps along the image axis that is closer to the edge's direction and scans across it.
  void CollectEdge(std::size_t edge) {
    const Eigen::Vector2d a = corners_[edge];
    const Eigen::Vector2d b = corners_[(edge + 1) % 4];
    const int along = std::abs(b.x() - a.x()) > std::abs(b.y() - a.y()) ? 0 : 1;
    const int across = 1 - along;
    const double slope = (b[across] - a[across]) / (b[along] - a[along]);
    // One pixel more than the band, because a distorted edge deviates from its chord.
    const double reach = (options_.band_px + 1.0) * std::sqrt(1.0 + slope * slope);
    const auto first = static_cast<int>(std::ceil(std::min(a[along], b[along])));
    const auto last = static_cast<int>(std::floor(std::max(a[along], b[along])));
    for (int s = first; s <= last; ++s) {
      const double middle = a[across] + slope * (s - a[along]);
      const auto low = static_cast<int>(std::ceil(middle - reach));
      const auto high = static_cast<int>(std::floor(middle + reach));
      for (int t = low; t <= high; ++t) {
        const Eigen::Vector2i pixel = along == 0 ? Eigen::Vector2i(s, t) : Eigen::Vector2i(t, s);
        Consider(pixel, edge);
      }
    }
  }

  EdgePixels Take() {
    while (last_ && pixels_.x.size() % kSimdWidth != 0) Add(*last_, pixels_.grey.back());
    return std::move(pixels_);
  }

 private:
  void Consider(const Eigen::Vector2i& pixel, std::size_t edge) {
    if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() >= grey_.cols || pixel.y() >= grey_.rows) {
      return;
    }
    const Eigen::Vector2d at = pixel.cast<double>();
    const double outward = Outward(at, edge);
    if (outward > bands_[edge].outward_px || outward < -options_.band_px) return;
    for (std::size_t other = 0; other < 4; ++other) {
      if (other == edge) continue;
      const double there = Outward(at, other);
      if (there > bands_[other].outward_px) return;
      // Each pixel belongs to the nearest edge; of equally near ones, to the first.
      const bool is_nearer = std::abs(there) < std::abs(outward) ||
                             (std::abs(there) == std::abs(outward) && other < edge);
      if (is_nearer) return;
    }
    for (const Eigen::Vector2d& corner : corners_) {
      if ((at - corner).squaredNorm() < options_.corner_radius_px * options_.corner_radius_px) {
        return;
      }
    }
    const std::optional<Undistortion::Point> straight =
        last_ ? undistortion_.UndistortNear(at, last_px_, *last_) : undistortion_.Undistort(at);
    if (!straight) return;
    last_ = straight;
    last_px_ = at;
    Add(*straight, static_cast<double>(grey_.at<std::uint8_t>(pixel.y(), pixel.x())));
    ++pixels_.count;
    ++pixels_.on_edge[edge];
  }

  void Add(const Undistortion::Point& straight, double grey) {
    pixels_.x.push_back(straight.straight_px.x());
    pixels_.y.push_back(straight.straight_px.y());
    pixels_.x_by_u.push_back(straight.straight_by_pixel(0, 0));
    pixels_.x_by_v.push_back(straight.straight_by_pixel(0, 1));
    pixels_.y_by_u.push_back(straight.straight_by_pixel(1, 0));
    pixels_.y_by_v.push_back(straight.straight_by_pixel(1, 1));
    pixels_.grey.push_back(grey);
  }

  double Outward(const Eigen::Vector2d& at, std::size_t edge) const {
    return bands_[edge].line.normal.dot(at) - bands_[edge].line.offset;
  }

  const cv::Mat& grey_;
  const Quad& corners_;
  std::array<Band, 4> bands_;
  const Undistortion& undistortion_;
  const EdgeRefineOptions& options_;
  EdgePixels pixels_;
  std::optional<Undistortion::Point> last_;  // Initial value for the next pixel's undistortion.
  Eigen::Vector2d last_px_ = Eigen::Vector2d::Zero();
};

}  // namespace

EdgePixels CollectEdgePixels(const cv::Mat& grey, const Quad& corners_px, const TagPattern& pattern,
                             const Undistortion& undistortion, const EdgeRefineOptions& options) {
  Collector collector(grey, corners_px, pattern, undistortion, options);
  for (std::size_t edge = 0; edge < 4; ++edge) collector.CollectEdge(edge);
  return collector.Take();
}

}  // namespace sextant
