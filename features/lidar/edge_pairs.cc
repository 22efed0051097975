// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/edge_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace sextant {
namespace {

constexpr double kReachSpacings = 3.0;  // Rays further apart hardly constrain an edge.
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// A ray's intersection with the plane.
struct Sample {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  std::size_t place = 0;  // Index into ScanRings::points().
  bool hides = false;     // The ray ends in front of the plane.
};

// Samples sorted into square cells, to find the nearest within a cell's width.
class SampleGrid {
 public:
  SampleGrid(const std::vector<Sample>& samples, double cell_m) : samples_(samples), cell_(cell_m) {
    low_ = high_ = samples.front().at;
    for (const Sample& sample : samples) {
      low_ = low_.cwiseMin(sample.at);
      high_ = high_.cwiseMax(sample.at);
    }
    columns_ = Cell(high_.x() - low_.x()) + 1;
    rows_ = Cell(high_.y() - low_.y()) + 1;
    starts_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
    for (const Sample& sample : samples) ++starts_[CellOf(sample.at) + 1];
    for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    order_.resize(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) order_[next[CellOf(samples[i].at)]++] = i;
  }

  // kNone if none is nearer than a cell's width.
  std::size_t Nearest(const Eigen::Vector2d& at) const {
    std::size_t nearest = kNone;
    double least = cell_ * cell_;
    const long column = Cell(at.x() - low_.x());
    const long row = Cell(at.y() - low_.y());
    for (long r = std::max(0L, row - 1); r <= std::min(rows_ - 1, row + 1); ++r) {
      for (long c = std::max(0L, column - 1); c <= std::min(columns_ - 1, column + 1); ++c) {
        const auto cell = static_cast<std::size_t>(r * columns_ + c);
        for (std::size_t i = starts_[cell]; i < starts_[cell + 1]; ++i) {
          const double distance2 = (samples_[order_[i]].at - at).squaredNorm();
          if (distance2 >= least) continue;
          least = distance2;
          nearest = order_[i];
        }
      }
    }
    return nearest;
  }

 private:
  long Cell(double offset) const { return static_cast<long>(std::floor(offset / cell_)); }
  std::size_t CellOf(const Eigen::Vector2d& at) const {
    return static_cast<std::size_t>(Cell(at.y() - low_.y()) * columns_ + Cell(at.x() - low_.x()));
  }

  const std::vector<Sample>& samples_;
  double cell_;
  Eigen::Vector2d low_;
  Eigen::Vector2d high_;
  long columns_ = 0;
  long rows_ = 0;
  std::vector<std::size_t> starts_;
  std::vector<std::size_t> order_;
};

struct BothSides {
  std::vector<Sample> on;
  std::vector<Sample> off;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  // Middle of those on the plane.
};

// Divides rays into those that end on the plane and those that pass it, within `reach_m` of the
// plane's points. Returns just off the plane belong to neither.
BothSides Divide(const ScanRings& scan, const LidarPlane& plane,
                 std::span<const std::size_t> on_plane, double reach_m) {
  BothSides sides;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector2d high = -low;
  for (const std::size_t place : on_plane) {
    const std::optional<Eigen::Vector2d> at = plane.Meet(scan.points()[place].point);
    if (!at) continue;
    sides.on.push_back({*at, place, false});
    low = low.cwiseMin(*at);
    high = high.cwiseMax(*at);
  }
  sides.middle = 0.5 * (low + high);
  const Eigen::Vector2d most = 0.5 * (high - low) + Eigen::Vector2d::Constant(reach_m);
  const double clear = 0.05 + 5.0 * plane.sigma_m;
  for (std::size_t place = 0; place < scan.points().size(); ++place) {
    const Eigen::Vector3d& point = scan.points()[place].point;
    const double beyond = plane.normal.dot(point - plane.origin);
    if (std::abs(beyond) < clear) continue;
    const std::optional<Eigen::Vector2d> at = plane.Meet(point);
    if (!at || ((*at - sides.middle).cwiseAbs().array() > most.array()).any()) continue;
    sides.off.push_back({*at, place, beyond < 0.0});
  }
  return sides;
}

}  // namespace

std::vector<EdgePoint> FindEdgePairs(const ScanRings& scan, const LidarPlane& plane,
                                     std::span<const std::size_t> on_plane,
                                     const EdgeOptions& options) {
  const double spacing = std::sqrt(scan.azimuth_step_rad() * scan.elevation_step_rad());
  const double slant = plane.normal.dot(plane.origin.normalized());
  const double reach = kReachSpacings * spacing * plane.origin.norm() / std::max(0.1, slant);
  const BothSides sides = Divide(scan, plane, on_plane, reach);
  std::vector<EdgePoint> edges;
  if (sides.on.empty() || sides.off.empty()) return edges;
  const SampleGrid on_grid(sides.on, reach);
  const SampleGrid off_grid(sides.off, reach);
  for (std::size_t i = 0; i < sides.on.size(); ++i) {
    const Sample& on = sides.on[i];
    const std::size_t nearest = off_grid.Nearest(on.at);
    if (nearest == kNone || sides.off[nearest].hides) continue;
    const Sample& off = sides.off[nearest];
    if (on_grid.Nearest(off.at) != i) continue;
    const Eigen::Vector2d across = off.at - on.at;
    const double step = across.norm();
    if (step < 1e-9) continue;
    const RingPoint& last = scan.points()[on.place];
    EdgePoint edge{.in_plane = on.at,
                   .outward = across / step,
                   .step_m = step,
                   .across = false,
                   .inner = options.hollow && across.dot(off.at - sides.middle) < 0.0,
                   .ring = scan.RingOf(on.place),
                   .last_return = last.point};
    if (options.correct) edge.in_plane += edge.outward * (0.5 * step);
    SetSpot(scan, plane, last.point, options, edge);
    edges.push_back(edge);
  }
  return edges;
}

}  // namespace sextant
