// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/near_copies.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "base/median.h"

namespace sextant {
namespace {

// Points closer than this part of the extent are equal up to rounding.
constexpr double kRounding = 1e-9;

// Subtracts the median point and divides by the median distance from it, which a few far points do
// not change. No answer for points without extent.
std::optional<Eigen::MatrixXd> Normalised(const Eigen::MatrixXd& points) {
  Eigen::MatrixXd centred = points;
  std::vector<double> values(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index axis = 0; axis < points.rows(); ++axis) {
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      values[static_cast<std::size_t>(i)] = points(axis, i);
    }
    centred.row(axis).array() -= UpperMedian(values);
  }
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    values[static_cast<std::size_t>(i)] = centred.col(i).norm();
  }
  const double extent = UpperMedian(values);
  if (!(extent > 0.0) || !std::isfinite(extent)) return std::nullopt;
  return centred / extent;
}

// Columns in the order of their coordinates along a direction in which no wall or board is flat, so
// that those near a point are found in a window.
class SortedColumns {
 public:
  explicit SortedColumns(const Eigen::MatrixXd& points) : points_(points) {
    const Eigen::Vector3d direction = Eigen::Vector3d(0.4142, 0.6180, 0.7321).normalized();
    const Eigen::VectorXd along = points.topRows<3>().transpose() * direction;
    for (Eigen::Index i = 0; i < points.cols(); ++i) sorted_.emplace_back(along[i], i);
    std::ranges::sort(sorted_);
    place_.resize(sorted_.size());
    for (std::size_t k = 0; k < sorted_.size(); ++k) {
      place_[static_cast<std::size_t>(sorted_[k].second)] = k;
    }
  }

  // Calls visit(j, distance) for every other column j no further from i than `radius`, which visit
  // may lower.
  template <class Visit>
  void Near(Eigen::Index i, double& radius, const Visit& visit) const {
    const std::size_t place = place_[static_cast<std::size_t>(i)];
    std::size_t below = place;
    std::size_t above = place + 1;
    const auto gap = [&](std::size_t k) {
      return std::abs(sorted_[k].first - sorted_[place].first);
    };
    const auto look = [&](std::size_t k) {
      const Eigen::Index j = sorted_[k].second;
      const double distance = (points_.col(j) - points_.col(i)).norm();
      if (distance <= radius) visit(j, distance);
    };
    bool is_below = true;
    bool is_above = true;
    while (is_below || is_above) {
      is_below = below > 0 && gap(below - 1) <= radius;
      if (is_below) look(--below);
      is_above = above < sorted_.size() && gap(above) <= radius;
      if (is_above) look(above++);
    }
  }

  // Distance of column i to the nearest other one that differs from it.
  double NearestDistance(Eigen::Index i) const {
    double nearest = std::numeric_limits<double>::infinity();
    Near(i, nearest, [&](Eigen::Index, double distance) {
      if (distance > kRounding) nearest = std::min(nearest, distance);
    });
    return nearest;
  }

 private:
  const Eigen::MatrixXd& points_;
  std::vector<std::pair<double, Eigen::Index>> sorted_;
  std::vector<std::size_t> place_;
};

struct Clusters {
  std::vector<int> of_point;
  std::vector<int> sizes;
  Eigen::MatrixXd means;
  double spread = 0.0;  // RMS distance of a member from the mean of its cluster.
};

void AddMeans(const Eigen::MatrixXd& points, Clusters& clusters) {
  const auto count = 1 + *std::ranges::max_element(clusters.of_point);
  clusters.sizes.assign(static_cast<std::size_t>(count), 0);
  clusters.means = Eigen::MatrixXd::Zero(points.rows(), count);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const int c = clusters.of_point[static_cast<std::size_t>(i)];
    ++clusters.sizes[static_cast<std::size_t>(c)];
    clusters.means.col(c) += points.col(i);
  }
  for (int c = 0; c < count; ++c) {
    clusters.means.col(c) /= clusters.sizes[static_cast<std::size_t>(c)];
  }
  double squares = 0.0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const int c = clusters.of_point[static_cast<std::size_t>(i)];
    squares += (points.col(i) - clusters.means.col(c)).squaredNorm();
  }
  const auto free = static_cast<double>(points.cols() - count);
  clusters.spread = free > 0.0 ? std::sqrt(squares / free) : 0.0;
}

Clusters ClustersWithin(const Eigen::MatrixXd& points, const SortedColumns& sorted, double radius) {
  Clusters clusters;
  clusters.of_point.assign(static_cast<std::size_t>(points.cols()), -1);
  int count = 0;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (clusters.of_point[static_cast<std::size_t>(i)] >= 0) continue;
    clusters.of_point[static_cast<std::size_t>(i)] = count;
    sorted.Near(i, radius, [&](Eigen::Index j, double) {
      int& of_other = clusters.of_point[static_cast<std::size_t>(j)];
      if (of_other < 0) of_other = count;
    });
    ++count;
  }
  AddMeans(points, clusters);
  return clusters;
}

constexpr double kMinShare = 0.75;
constexpr double kClear = 8.0;  // Clusters this many spreads apart are distinct.

// Parts of one cluster may have become clusters of their own: those near to a cluster that is at
// least as large, and small ones less near to a far larger one, join it.
void JoinFragments(const Eigen::MatrixXd& points, Clusters& clusters) {
  constexpr double kNear = 4.0;
  constexpr int kFarLarger = 4;
  const SortedColumns sorted(clusters.means);
  const auto count = static_cast<std::size_t>(clusters.means.cols());
  std::vector<int> target(count);
  std::iota(target.begin(), target.end(), 0);
  for (std::size_t c = 0; c < count; ++c) {
    double radius = kClear * clusters.spread;
    const int size = clusters.sizes[c];
    sorted.Near(static_cast<Eigen::Index>(c), radius, [&](Eigen::Index other, double distance) {
      const auto o = static_cast<std::size_t>(other);
      const int of_other = clusters.sizes[o];
      const bool is_larger = of_other > size || (of_other == size && o < c);
      const bool is_near = is_larger && distance <= kNear * clusters.spread;
      if (!is_near && of_other < kFarLarger * size) return;
      target[c] = static_cast<int>(other);
      radius = distance;
    });
  }
  std::vector<int> number(count, -1);
  int numbers = 0;
  for (int& c : clusters.of_point) {
    // Chains end, because each target is larger or of lower index.
    while (target[static_cast<std::size_t>(c)] != c) c = target[static_cast<std::size_t>(c)];
    int& known = number[static_cast<std::size_t>(c)];
    if (known < 0) known = numbers++;
    c = known;
  }
  AddMeans(points, clusters);
}

// The share of the clusters that are far from all others; 0 unless most have several members.
double ShareOfClear(const Clusters& clusters) {
  constexpr std::size_t kMinClusters = 3;
  if (clusters.sizes.size() < kMinClusters) return 0.0;
  const auto repeated = std::ranges::count_if(clusters.sizes, [](int size) { return size > 1; });
  const auto count = static_cast<double>(clusters.sizes.size());
  if (static_cast<double>(repeated) < kMinShare * count) return 0.0;
  const SortedColumns sorted(clusters.means);
  double clear = 0.0;
  for (Eigen::Index c = 0; c < clusters.means.cols(); ++c) {
    if (sorted.NearestDistance(c) >= kClear * clusters.spread) clear += 1.0;
  }
  return clear / count;
}

// Whether the members of each cluster are one corner in different views.
bool AreCornersOfViews(const Clusters& clusters, std::span<const PairId> ids) {
  std::vector<const PairId*> first(clusters.sizes.size(), nullptr);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const PairId*& known = first[static_cast<std::size_t>(clusters.of_point[i])];
    if (known == nullptr) {
      known = &ids[i];
    } else if (known->board != ids[i].board || known->corner != ids[i].corner ||
               known->view == ids[i].view) {
      return false;
    }
  }
  return true;
}

// Whether the differences within the clusters are unrelated between the sensors: a linear map of
// those in the LiDAR explains less than half of those in the camera. Each cluster counts by its
// members, whatever its distance. With too few members only ids can tell.
bool AreUnrelatedWithin(const Clusters& clusters, const Eigen::MatrixXd& points,
                        std::span<const PairId> ids) {
  constexpr double kMaxExplained = 0.5;
  constexpr double kRegressors = 3.0;
  constexpr double kMinFree = 4.0;
  const Eigen::Index observed = points.rows() - 3;
  const auto free = static_cast<double>(points.cols() - clusters.means.cols());
  if (free < kMinFree) return AreCornersOfViews(clusters, ids);
  Eigen::MatrixXd offsets = points;
  Eigen::Matrix2Xd squares = Eigen::Matrix2Xd::Zero(2, clusters.means.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const int c = clusters.of_point[static_cast<std::size_t>(i)];
    offsets.col(i) -= clusters.means.col(c);
    squares(0, c) += offsets.col(i).head<3>().squaredNorm();
    squares(1, c) += offsets.col(i).tail(observed).squaredNorm();
  }
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const int c = clusters.of_point[static_cast<std::size_t>(i)];
    const double members = clusters.sizes[static_cast<std::size_t>(c)];
    const auto scale = [&](double sum) { return std::sqrt(members / std::max(sum, 1e-30)); };
    offsets.col(i).head<3>() *= scale(squares(0, c));
    offsets.col(i).tail(observed) *= scale(squares(1, c));
  }
  const Eigen::MatrixXd lidar = offsets.topRows<3>();
  const Eigen::MatrixXd camera = offsets.bottomRows(observed);
  const double total = camera.squaredNorm();
  if (!(total > 0.0)) return true;
  Eigen::Matrix3d normal = lidar * lidar.transpose();
  normal.diagonal().array() += 1e-9 * normal.trace() + 1e-30;
  const Eigen::MatrixXd cross = lidar * camera.transpose();
  const double explained = cross.cwiseProduct(normal.ldlt().solve(cross)).sum() / total;
  return 1.0 - (1.0 - explained) * free / (free - kRegressors) < kMaxExplained;
}

// The median distance of a point to the nearest other one. None where the points have no gap: those
// spread over a room, a wall or a line have two to eight times as many others within twice the
// radius, and the rest would take long for many points.
std::optional<double> NearestOfMost(const Eigen::MatrixXd& points, const SortedColumns& sorted) {
  constexpr Eigen::Index kMaxSample = 500;
  constexpr double kMaxGrowth = 1.8;
  constexpr std::array kRadii = {3.0, 6.0, 12.0};
  const Eigen::Index step = 1 + (points.cols() - 1) / kMaxSample;
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < points.cols(); i += step) {
    distances.push_back(sorted.NearestDistance(i));
  }
  const double nearest = UpperMedian(distances);
  if (!std::isfinite(nearest)) return std::nullopt;
  if (step == 1) return nearest;
  std::array<double, kRadii.size()> within = {};
  for (Eigen::Index i = 0; i < points.cols(); i += step) {
    double radius = kRadii.back() * nearest;
    sorted.Near(i, radius, [&](Eigen::Index, double distance) {
      for (std::size_t k = 0; k < kRadii.size(); ++k) {
        if (distance <= kRadii[k] * nearest) within[k] += 1.0;
      }
    });
  }
  for (std::size_t k = 1; k < kRadii.size(); ++k) {
    if (within[k] <= kMaxGrowth * within[k - 1]) return nearest;
  }
  return std::nullopt;
}

}  // namespace

std::vector<int> PointsOfNearCopies(const Eigen::Matrix3Xd& in_lidar,
                                    const Eigen::MatrixXd& observed, std::span<const PairId> ids) {
  constexpr Eigen::Index kMinPairs = 6;
  const Eigen::Index count = in_lidar.cols();
  if (count < kMinPairs || !in_lidar.allFinite() || !observed.allFinite()) return {};
  const auto lidar = Normalised(in_lidar);
  const auto camera = Normalised(observed);
  if (!lidar || !camera) return {};
  Eigen::MatrixXd points(lidar->rows() + camera->rows(), count);
  points << *lidar, *camera;
  const SortedColumns sorted(points);
  const std::optional<double> nearest = NearestOfMost(points, sorted);
  if (!nearest) return {};
  double best = 0.0;
  Clusters chosen;
  for (const double multiple : {3.0, 6.0, 12.0}) {
    Clusters clusters = ClustersWithin(points, sorted, multiple * *nearest);
    for (int round = 0; round < 3; ++round) JoinFragments(points, clusters);
    const double clear = ShareOfClear(clusters);
    if (clear < kMinShare || clear <= best) continue;
    best = clear;
    chosen = std::move(clusters);
  }
  if (best == 0.0 || !AreUnrelatedWithin(chosen, points, ids)) return {};
  return chosen.of_point;
}

}  // namespace sextant
