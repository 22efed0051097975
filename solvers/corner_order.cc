// SPDX-License-Identifier: Apache-2.0
#include "solvers/corner_order.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "solvers/kabsch.h"

namespace sextant {
namespace {

using Points = std::vector<Eigen::Vector3d>;

int CornersOf(const CornerGroup& group) { return static_cast<int>(group.in_b.size()); }

// Order 0 is that of the lists; the first n keep the direction.
CornerOrder OrderAt(int index, int corners) {
  return {.first = index % corners, .reversed = index >= corners};
}

double SumSquares(const CornerGroup& group, const CornerOrder& order, const Rigid3d& b_from_a) {
  const int n = CornersOf(group);
  double sum = 0.0;
  for (int k = 0; k < n; ++k) {
    const auto in_a = static_cast<std::size_t>(order.IndexInA(k, n));
    sum += (group.in_b[static_cast<std::size_t>(k)] - b_from_a * group.in_a[in_a]).squaredNorm();
  }
  return sum;
}

void AppendOrdered(const CornerGroup& group, const CornerOrder& order, Points& in_b, Points& in_a) {
  const int n = CornersOf(group);
  for (int k = 0; k < n; ++k) {
    in_b.push_back(group.in_b[static_cast<std::size_t>(k)]);
    in_a.push_back(group.in_a[static_cast<std::size_t>(order.IndexInA(k, n))]);
  }
}

Eigen::Vector3d Centroid(const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

std::vector<Rigid3d> Starts(std::span<const CornerGroup> groups) {
  std::vector<Rigid3d> starts;
  Points in_b;
  Points in_a;
  for (const CornerGroup& group : groups) {
    in_b.push_back(Centroid(group.in_b));
    in_a.push_back(Centroid(group.in_a));
  }
  if (const Expected<KabschFit> fit = FitKabsch(in_b, in_a)) starts.push_back(fit->b_from_a);
  const int corners = CornersOf(groups[0]);
  for (int i = 0; i < 2 * corners; ++i) {
    in_b.clear();
    in_a.clear();
    AppendOrdered(groups[0], OrderAt(i, corners), in_b, in_a);
    if (const Expected<KabschFit> fit = FitKabsch(in_b, in_a)) starts.push_back(fit->b_from_a);
  }
  return starts;
}

std::optional<CornerOrderFit> Descend(std::span<const CornerGroup> groups, const Rigid3d& start) {
  CornerOrderFit fit;
  fit.b_from_a = start;
  constexpr int kMaxIterations = 100;
  for (fit.iterations = 1; fit.iterations <= kMaxIterations; ++fit.iterations) {
    std::vector<CornerOrder> orders;
    Points in_b;
    Points in_a;
    for (const CornerGroup& group : groups) {
      orders.push_back(BestCornerOrder(group, fit.b_from_a));
      AppendOrdered(group, orders.back(), in_b, in_a);
    }
    if (orders == fit.orders) break;
    const Expected<KabschFit> kabsch = FitKabsch(in_b, in_a);
    if (!kabsch) return std::nullopt;
    fit.orders = std::move(orders);
    fit.b_from_a = kabsch->b_from_a;
    fit.rmse_m = std::sqrt(kabsch->sum_squares / static_cast<double>(in_b.size()));
  }
  return fit;
}

}  // namespace

CornerOrder BestCornerOrder(const CornerGroup& group, const Rigid3d& b_from_a) {
  CornerOrder best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2 * CornersOf(group); ++i) {
    const CornerOrder order = OrderAt(i, CornersOf(group));
    const double sum = SumSquares(group, order, b_from_a);
    if (sum < least) {
      least = sum;
      best = order;
    }
  }
  return best;
}

Expected<CornerOrderFit> ResolveCornerOrders(std::span<const CornerGroup> groups) {
  if (groups.empty()) {
    return MakeError(ErrorCode::kTooFewPairs, "the order of corners needs at least one board");
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const CornerGroup& group = groups[i];
    if (group.in_a.size() == group.in_b.size() && group.in_b.size() >= 3) continue;
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("board {} of {} has {} and {} corners, expected equally many, at "
                                 "least 3",
                                 i + 1, groups.size(), group.in_b.size(), group.in_a.size()));
  }
  std::optional<CornerOrderFit> best;
  // Equal to a micrometre is equal: the earliest start, nearest to the lists, then stays.
  constexpr double kNoticeableMetres = 1e-6;
  for (const Rigid3d& start : Starts(groups)) {
    std::optional<CornerOrderFit> fit = Descend(groups, start);
    if (fit && (!best || fit->rmse_m < best->rmse_m - kNoticeableMetres)) best = std::move(fit);
  }
  if (!best) {
    return MakeError(ErrorCode::kDegenerate,
                     "no order of the corners gives a pose: the corners of a sensor coincide or "
                     "lie on one line");
  }
  return *best;
}

}  // namespace sextant
