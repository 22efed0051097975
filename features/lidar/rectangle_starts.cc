// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rectangle_starts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace sextant {
namespace {

constexpr int kAnglesPerQuarter = 20;
constexpr double kMinOutwardCosine = 0.12;  // A ring along a side does not cross it.
constexpr double kSlack_m = 0.02;
constexpr std::size_t kPlacesPerAxis = 2;

struct Vote {
  double center = 0.0;
  int sign = 0;  // Sign of the side: +1 for the one in the direction of the axis.
};

// A position along one axis of the rectangle, and how many edge points support it.
struct AxisPlace {
  double center = 0.0;
  double support = 0.0;
};

// The windows with the most votes. Votes of both opposite sides count more: a single side may be
// any straight edge.
std::vector<AxisPlace> BestWindows(std::vector<Vote>& votes, double width) {
  std::ranges::sort(votes, {}, &Vote::center);
  std::vector<AxisPlace> windows;
  std::array<int, 2> counts{};
  double sum = 0.0;
  std::size_t first = 0;
  for (std::size_t last = 0; last < votes.size(); ++last) {
    ++counts[votes[last].sign > 0 ? 1 : 0];
    sum += votes[last].center;
    while (votes[last].center - votes[first].center > width) {
      --counts[votes[first].sign > 0 ? 1 : 0];
      sum -= votes[first].center;
      ++first;
    }
    const int both = std::min(counts[0], counts[1]);
    windows.push_back({sum / static_cast<double>(last - first + 1),
                       static_cast<double>(counts[0] + counts[1] + both)});
  }
  std::ranges::stable_sort(windows, std::greater<>{}, &AxisPlace::support);
  std::vector<AxisPlace> best;
  for (const AxisPlace& window : windows) {
    if (best.size() == kPlacesPerAxis) break;
    const bool is_new = std::ranges::none_of(best, [&](const AxisPlace& other) {
      return std::abs(other.center - window.center) < width;
    });
    if (is_new) best.push_back(window);
  }
  return best;
}

class Voting {
 public:
  Voting(std::span<const EdgePoint> edges, const Eigen::Vector2d& half)
      : edges_(edges), half_(half) {}

  struct Start {
    Eigen::Vector3d pose;
    double support;
  };

  void AddStarts(double angle, std::vector<Start>& starts) const {
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
    const std::vector<AxisPlace> xs = PlacesAlong(turn, 0);
    const std::vector<AxisPlace> ys = PlacesAlong(turn, 1);
    for (const AxisPlace& x : xs) {
      for (const AxisPlace& y : ys) {
        const Eigen::Vector2d center = turn * Eigen::Vector2d(x.center, y.center);
        starts.push_back({{center.x(), center.y(), angle}, x.support + y.support});
      }
    }
  }

 private:
  std::vector<AxisPlace> PlacesAlong(const Eigen::Matrix2d& turn, Eigen::Index axis) const {
    const Eigen::Vector2d direction = turn.col(axis);
    const double half = half_(axis);
    std::vector<Vote> votes;
    double low = std::numeric_limits<double>::max();
    double high = -low;
    for (const EdgePoint& edge : edges_) {
      const double at = direction.dot(edge.in_plane);
      low = std::min(low, at);
      high = std::max(high, at);
      const double outward = direction.dot(edge.outward);
      if (edge.inner || std::abs(outward) < kMinOutwardCosine) continue;
      const int sign = outward > 0.0 ? 1 : -1;
      votes.push_back({at - sign * half, sign});
    }
    constexpr double kHalfStep = 0.25 * std::numbers::pi / kAnglesPerQuarter;
    const double slack = kSlack_m + kHalfStep * half_(1 - axis);
    std::vector<AxisPlace> places = BestWindows(votes, 2.0 * slack);
    // No ring crosses a side of this axis: the edge points' middle.
    if (places.empty()) places.push_back({0.5 * (low + high), 0.0});
    return places;
  }

  std::span<const EdgePoint> edges_;
  Eigen::Vector2d half_;
};

}  // namespace

std::vector<Eigen::Vector3d> RectangleStarts(std::span<const EdgePoint> edges,
                                             const Eigen::Vector2d& half, std::size_t max_count) {
  const Voting voting(edges, half);
  const int angles = IsSquare(half) ? kAnglesPerQuarter : 2 * kAnglesPerQuarter;
  std::vector<Voting::Start> starts;
  for (int i = 0; i < angles; ++i) {
    voting.AddStarts((i + 0.5) * 0.5 * std::numbers::pi / kAnglesPerQuarter, starts);
  }
  std::ranges::stable_sort(starts, std::greater<>{}, &Voting::Start::support);
  if (starts.size() > max_count) starts.resize(max_count);
  std::vector<Eigen::Vector3d> poses;
  for (const Voting::Start& start : starts) poses.push_back(start.pose);
  return poses;
}

}  // namespace sextant
