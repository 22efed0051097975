// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/round_holes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/median.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

// All lengths relative to the radius of a hole.
constexpr double kCell = 0.2;
constexpr double kEmptyDisc = 0.65;
constexpr double kAroundFrom = 1.15;
constexpr double kAroundTo = 1.9;
constexpr double kSharp = 0.1;  // Points of a rim further from the circle count less.
constexpr double kRimFrom = 0.5;
constexpr double kRimTo = 1.5;
constexpr double kOtherRadius = 0.25;
constexpr double kSamePlace = 0.25;

constexpr double kMaxFilled = 0.05;  // Density of returns in a hole, relative to that around it.
constexpr std::size_t kSectors = 8;
constexpr std::size_t kMinSectors = 7;  // With returns around a hole.
constexpr std::size_t kMaxHoles = 24;
constexpr std::size_t kMaxCells = 4000000;
constexpr double kBinSpacings = 3.0;  // Width of a bin around a rim.
constexpr int kMinBins = 12;
constexpr int kMaxBins = 90;
constexpr int kCircleRounds = 4;
constexpr double kFullTurn = 2.0 * std::numbers::pi;

struct PlaneReturn {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  std::size_t place = 0;  // Index into ScanRings::points().
};

std::vector<PlaneReturn> ReturnsOn(const ScanRings& scan, const LidarPlane& plane,
                                   std::span<const std::size_t> on_plane) {
  std::vector<PlaneReturn> returns;
  returns.reserve(on_plane.size());
  for (const std::size_t place : on_plane) {
    const std::optional<Eigen::Vector2d> at = plane.Meet(scan.points()[place].point);
    if (at) returns.push_back({*at, place});
  }
  return returns;
}

// Returns counted in square cells.
class CellCounts {
 public:
  CellCounts(std::span<const PlaneReturn> returns, double cell_m) : cell_(cell_m) {
    low_ = returns.front().at;
    Eigen::Vector2d high = low_;
    for (const PlaneReturn& one : returns) {
      low_ = low_.cwiseMin(one.at);
      high = high.cwiseMax(one.at);
    }
    columns_ = static_cast<long>((high.x() - low_.x()) / cell_) + 1;
    rows_ = static_cast<long>((high.y() - low_.y()) / cell_) + 1;
    if (!IsAffordable()) return;
    counts_.assign(static_cast<std::size_t>(columns_ * rows_), 0);
    for (const PlaneReturn& one : returns) {
      const Eigen::Vector2d offset = (one.at - low_) / cell_;
      ++counts_[Index(static_cast<long>(offset.x()), static_cast<long>(offset.y()))];
    }
    densest_ = *std::ranges::max_element(counts_);
  }

  bool IsAffordable() const {
    return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) <= kMaxCells;
  }
  int densest() const { return densest_; }
  long columns() const { return columns_; }
  long rows() const { return rows_; }
  int Count(long column, long row) const {
    if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return 0;
    return counts_[Index(column, row)];
  }
  Eigen::Vector2d CenterOf(long column, long row) const {
    return low_ + cell_ * Eigen::Vector2d(static_cast<double>(column) + 0.5,
                                          static_cast<double>(row) + 0.5);
  }

 private:
  std::size_t Index(long column, long row) const {
    return static_cast<std::size_t>(row * columns_ + column);
  }

  double cell_;
  Eigen::Vector2d low_;
  long columns_ = 0;
  long rows_ = 0;
  int densest_ = 0;
  std::vector<int> counts_;
};

// Cells around a place: those of an empty disc, and those of the ring around it, by sector.
struct HoleMask {
  struct Cell {
    long column;
    long row;
    std::size_t sector;
  };
  std::vector<Cell> disc{};
  std::vector<Cell> around{};

  HoleMask() {
    const auto reach = static_cast<long>(std::ceil(kAroundTo / kCell));
    for (long row = -reach; row <= reach; ++row) {
      for (long column = -reach; column <= reach; ++column) {
        const double x = kCell * static_cast<double>(column);
        const double y = kCell * static_cast<double>(row);
        const double from = std::hypot(x, y);
        const double turn = std::atan2(y, x) / kFullTurn + 0.5;
        const auto sector = static_cast<std::size_t>(turn * kSectors) % kSectors;
        if (from <= kEmptyDisc) disc.push_back({column, row, sector});
        if (from >= kAroundFrom && from <= kAroundTo) around.push_back({column, row, sector});
      }
    }
  }

  bool Fits(const CellCounts& counts, long column, long row) const {
    int in_disc = 0;
    for (const Cell& cell : disc) in_disc += counts.Count(column + cell.column, row + cell.row);
    // The cheap test first: as many returns as the densest cells would allow around the hole.
    if (in_disc > kMaxFilled * counts.densest() * static_cast<double>(disc.size())) return false;
    std::array<int, kSectors> sectors{};
    int around_count = 0;
    for (const Cell& cell : around) {
      const int count = counts.Count(column + cell.column, row + cell.row);
      sectors[cell.sector] += count;
      around_count += count;
    }
    if (kSectors - static_cast<std::size_t>(std::ranges::count(sectors, 0)) < kMinSectors) {
      return false;
    }
    const double expected = static_cast<double>(around_count) * static_cast<double>(disc.size()) /
                            static_cast<double>(around.size());
    return in_disc <= kMaxFilled * expected;
  }
};

// The middles of groups of places at which a hole of the radius fits.
std::vector<Eigen::Vector2d> EmptyPlaces(std::span<const PlaneReturn> returns, double radius_m) {
  static const HoleMask mask;
  struct Group {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double count = 0.0;
  };
  std::vector<Group> groups;
  const CellCounts counts(returns, kCell * radius_m);
  if (!counts.IsAffordable()) return {};
  for (long row = 0; row < counts.rows(); ++row) {
    for (long column = 0; column < counts.columns(); ++column) {
      if (counts.Count(column, row) > 0 || !mask.Fits(counts, column, row)) continue;
      const Eigen::Vector2d at = counts.CenterOf(column, row);
      const auto near = std::ranges::find_if(groups, [&](const Group& group) {
        return (group.sum / group.count - at).norm() < radius_m;
      });
      Group& group = near == groups.end() ? groups.emplace_back() : *near;
      group.sum += at;
      group.count += 1.0;
    }
  }
  std::ranges::stable_sort(groups, std::greater<>{}, &Group::count);
  std::vector<Eigen::Vector2d> places;
  for (const Group& group : groups) places.emplace_back(group.sum / group.count);
  if (places.size() > kMaxHoles) places.resize(kMaxHoles);
  return places;
}

struct Circle {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double radius = 0.0;
};

class RimFinder {
 public:
  RimFinder(std::span<const PlaneReturn> returns, double radius_m)
      : returns_(returns), radius_(radius_m) {}

  // The nearest return to the centre in each of a number of directions.
  std::vector<PlaneReturn> RimAround(const Eigen::Vector2d& center) const {
    std::vector<PlaneReturn> near;
    for (const PlaneReturn& one : returns_) {
      const double from = (one.at - center).norm();
      if (from > kRimFrom * radius_ && from < kAroundTo * radius_) near.push_back(one);
    }
    const auto bins = static_cast<std::size_t>(BinsFor(near.size()));
    std::vector<PlaneReturn> rim(bins);
    std::vector<double> nearest(bins, kRimTo * radius_);
    for (const PlaneReturn& one : near) {
      const Eigen::Vector2d arm = one.at - center;
      const double turn = std::atan2(arm.y(), arm.x()) / kFullTurn + 0.5;
      const std::size_t bin = static_cast<std::size_t>(turn * static_cast<double>(bins)) % bins;
      if (arm.norm() >= nearest[bin]) continue;
      nearest[bin] = arm.norm();
      rim[bin] = one;
    }
    std::vector<PlaneReturn> seen;
    for (std::size_t i = 0; i < bins; ++i) {
      if (nearest[i] < kRimTo * radius_) seen.push_back(rim[i]);
    }
    complete_ = 4 * seen.size() >= 3 * bins;
    bin_m_ = kFullTurn * radius_ / static_cast<double>(bins);
    return seen;
  }

  bool complete() const { return complete_; }  ///< Whether the last rim is nearly closed.
  /// Mean distance from a rim to the nearest return in a bin.
  double MeanGap() const { return 1.0 / (density_ * bin_m_); }

 private:
  int BinsFor(std::size_t near) const {
    const double area = std::numbers::pi * radius_ * radius_ * (kAroundTo * kAroundTo - 1.0);
    density_ = std::max(1.0, static_cast<double>(near)) / area;
    const double width = kBinSpacings / std::sqrt(density_);
    return std::clamp(static_cast<int>(kFullTurn * radius_ / width), kMinBins, kMaxBins);
  }

  std::span<const PlaneReturn> returns_;
  double radius_;
  mutable bool complete_ = false;
  mutable double density_ = 1.0;
  mutable double bin_m_ = 1.0;
};

// Least squares of the distances from the circle, each limited to a tenth of the radius.
Circle FitCircle(std::span<const PlaneReturn> rim, Circle circle) {
  for (int round = 0; round < kCircleRounds; ++round) {
    Eigen::Matrix3d normal = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (const PlaneReturn& one : rim) {
      const Eigen::Vector2d arm = one.at - circle.center;
      const double from = arm.norm();
      if (from <= 0.0) continue;
      const double residual = from - circle.radius;
      const double limit = kSharp * circle.radius;
      const double weight = std::abs(residual) <= limit ? 1.0 : limit / std::abs(residual);
      const Eigen::Vector3d j(-arm.x() / from, -arm.y() / from, -1.0);
      normal += weight * j * j.transpose();
      gradient += weight * residual * j;
    }
    const Eigen::Vector3d step = -SolveSymmetric<3>(normal, gradient);
    circle.center += step.head<2>();
    circle.radius += step.z();
  }
  return circle;
}

// Standard deviation of a rim's points about the circle, from the median of their distances: spots
// that are wider in one direction and mixed returns make a rim uneven.
double ScatterOf(std::span<const PlaneReturn> rim, const Circle& circle) {
  constexpr double kSigmaOfMedian = 1.4826;
  std::vector<double> off;
  off.reserve(rim.size());
  for (const PlaneReturn& one : rim) {
    off.push_back(std::abs((one.at - circle.center).norm() - circle.radius));
  }
  return kSigmaOfMedian * UpperMedian(off);
}

std::optional<SeenHole> FitHole(const ScanRings& scan, const LidarPlane& plane,
                                const RimFinder& finder, const Eigen::Vector2d& start,
                                double radius_m, const EdgeOptions& options) {
  Circle circle{start, radius_m};
  std::vector<PlaneReturn> rim;
  for (int round = 0; round < 2; ++round) {
    rim = finder.RimAround(circle.center);
    if (!finder.complete()) return std::nullopt;
    circle = FitCircle(rim, circle);
    if (!((circle.center - start).norm() < radius_m)) return std::nullopt;
  }
  rim = finder.RimAround(circle.center);
  if (!finder.complete()) return std::nullopt;
  const double gap = finder.MeanGap();
  SeenHole hole{.center = circle.center, .radius_m = circle.radius - gap};
  if (std::abs(hole.radius_m - radius_m) > kOtherRadius * radius_m) return std::nullopt;
  // The gap is distributed exponentially.
  const double sigma = std::max(gap, ScatterOf(rim, circle));
  for (const PlaneReturn& one : rim) {
    const RingPoint& last = scan.points()[one.place];
    EdgePoint edge{.in_plane = one.at,
                   .outward = (circle.center - one.at).normalized(),
                   .step_m = std::sqrt(12.0) * sigma,
                   .inner = true,
                   .ring = scan.RingOf(one.place),
                   .last_return = last.point};
    SetSpot(scan, plane, last.point, options, edge);
    const double off = (one.at - circle.center).norm() - circle.radius;
    edge.in_plane = circle.center - edge.outward * (radius_m + off - edge.Growth(edge.outward));
    hole.rim.push_back(edge);
  }
  return hole;
}

}  // namespace

std::vector<SeenHole> FindRoundHoles(const ScanRings& scan, const LidarPlane& plane,
                                     std::span<const std::size_t> on_plane, double radius_m,
                                     const EdgeOptions& options) {
  const std::vector<PlaneReturn> returns = ReturnsOn(scan, plane, on_plane);
  std::vector<SeenHole> holes;
  if (returns.empty()) return holes;
  const RimFinder finder(returns, radius_m);
  for (const Eigen::Vector2d& place : EmptyPlaces(returns, radius_m)) {
    std::optional<SeenHole> hole = FitHole(scan, plane, finder, place, radius_m, options);
    if (!hole) continue;
    const bool is_new = std::ranges::none_of(holes, [&](const SeenHole& other) {
      return (other.center - hole->center).norm() < radius_m;
    });
    if (is_new) holes.push_back(*std::move(hole));
  }
  return holes;
}

std::vector<Eigen::Vector3d> PlacementsByHoles(std::span<const SeenHole> seen, const Board& board,
                                               std::size_t max_count) {
  struct Start {
    Eigen::Vector3d pose = Eigen::Vector3d::Zero();
    std::size_t holes = 0;
  };
  const std::vector<RoundHole>& holes = board.round_holes;
  const std::size_t needed = std::clamp<std::size_t>(holes.size(), 2, 3);
  std::vector<Start> starts;
  const auto add = [&](const SeenHole& a, const SeenHole& b, const RoundHole& i,
                       const RoundHole& j) {
    const Eigen::Vector2d across = b.center - a.center;
    const Eigen::Vector2d in_board = j.center_in_board_m - i.center_in_board_m;
    if (std::abs(across.norm() - in_board.norm()) > kSamePlace * i.radius_m) return;
    const double angle =
        std::atan2(across.y(), across.x()) - std::atan2(in_board.y(), in_board.x());
    const Eigen::Rotation2Dd turn(angle);
    const Eigen::Vector2d center =
        0.5 * (a.center + b.center) - turn * (0.5 * (i.center_in_board_m + j.center_in_board_m));
    Start start{{center.x(), center.y(), angle}, 0};
    for (const RoundHole& hole : holes) {
      const Eigen::Vector2d at = center + turn * hole.center_in_board_m;
      start.holes += std::ranges::any_of(seen, [&](const SeenHole& other) {
        return (other.center - at).norm() < kSamePlace * hole.radius_m;
      });
    }
    if (start.holes >= needed) starts.push_back(start);
  };
  for (std::size_t a = 0; a < seen.size(); ++a) {
    for (std::size_t b = 0; b < seen.size(); ++b) {
      for (std::size_t i = 0; a != b && i < holes.size(); ++i) {
        for (std::size_t j = i + 1; j < holes.size(); ++j)
          add(seen[a], seen[b], holes[i], holes[j]);
      }
    }
  }
  std::ranges::stable_sort(starts, std::greater<>{}, &Start::holes);
  std::vector<Eigen::Vector3d> poses;
  for (const Start& start : starts) {
    if (poses.size() == max_count) break;
    const bool is_new = std::ranges::none_of(poses, [&](const Eigen::Vector3d& other) {
      return (other - start.pose).head<2>().norm() < 0.02 &&
             std::abs(std::remainder(other.z() - start.pose.z(), kFullTurn)) < 0.05;
    });
    if (is_new) poses.push_back(start.pose);
  }
  return poses;
}

HoledEdges FindHoledEdges(const ScanRings& scan, const LidarPlane& plane,
                          std::span<const std::size_t> on_plane, const Board& board,
                          const EdgeOptions& options) {
  constexpr std::size_t kMaxStarts = 6;
  constexpr std::ptrdiff_t kMinGapEnds = 6;  // Three crossings of holes, on one or more rings.
  HoledEdges found;
  found.edges = FindEdgePoints(scan, plane, on_plane, options);
  if (scan.has_rings() && std::ranges::count(found.edges, true, &EdgePoint::inner) < kMinGapEnds) {
    return found;
  }
  const double radius_m = board.round_holes.front().radius_m;
  const std::vector<SeenHole> seen = FindRoundHoles(scan, plane, on_plane, radius_m, options);
  found.starts = PlacementsByHoles(seen, board, kMaxStarts);
  if (scan.has_rings()) return found;
  std::erase_if(found.edges, [&](const EdgePoint& edge) {
    return std::ranges::any_of(seen, [&](const SeenHole& hole) {
      return (edge.in_plane - hole.center).norm() < kRimTo * hole.radius_m;
    });
  });
  for (EdgePoint& edge : found.edges) edge.inner = board.hole && edge.inner;
  for (const SeenHole& hole : seen) {
    found.edges.insert(found.edges.end(), hole.rim.begin(), hole.rim.end());
  }
  return found;
}

}  // namespace sextant
