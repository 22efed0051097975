// SPDX-License-Identifier: Apache-2.0
#include "solvers/matching/corner_order.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "solvers/kernels/kabsch.h"
#include "solvers/matching/object_match.h"

namespace sextant {
namespace {

using Points = std::vector<Eigen::Vector3d>;

int CornersOf(const CornerGroup& group) { return static_cast<int>(group.in_b.size()); }

// Order 0 is that of the lists; the first n keep the direction.
CornerOrder OrderAt(int index, int corners) {
  return {.first = index % corners, .reversed = index >= corners};
}

// The group as a view with one pairing per order: the points `in_a` of pairing i follow OrderAt(i).
MatchView ViewOf(const CornerGroup& group) {
  const int n = CornersOf(group);
  MatchView view;
  for (int i = 0; i < 2 * n; ++i) {
    ObjectPairing pairing{.points_in_b = group.in_b};
    for (int k = 0; k < n; ++k) {
      const auto in_a = static_cast<std::size_t>(OrderAt(i, n).IndexInA(k, n));
      pairing.points_in_a.push_back(group.in_a[in_a]);
    }
    view.pairings.push_back(std::move(pairing));
  }
  return view;
}

Eigen::Vector3d Centroid(const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

// A start that does not depend on the orders, as centroids do not.
std::vector<Rigid3d> FitOfCentroids(std::span<const CornerGroup> groups) {
  Points in_b;
  Points in_a;
  for (const CornerGroup& group : groups) {
    in_b.push_back(Centroid(group.in_b));
    in_a.push_back(Centroid(group.in_a));
  }
  const Expected<KabschFit> fit = FitKabsch(in_b, in_a);
  return fit ? std::vector<Rigid3d>{fit->b_from_a} : std::vector<Rigid3d>();
}

}  // namespace

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
  std::vector<MatchView> views;
  for (const CornerGroup& group : groups) views.push_back(ViewOf(group));
  const Expected<std::vector<MatchExplanation>> found =
      MatchObjects(views, {.starts = FitOfCentroids(groups)});
  if (!found) {
    return MakeError(ErrorCode::kDegenerate,
                     "no order of the corners gives a pose: the corners of a sensor coincide or "
                     "lie on one line");
  }
  const MatchExplanation& best = found->front();
  CornerOrderFit fit;
  fit.b_from_a = best.b_from_a;
  double points = 0.0;
  for (const TakenPairing& taken : best.taken) {
    const int corners = CornersOf(groups[taken.view]);
    fit.orders.push_back(OrderAt(static_cast<int>(taken.pairing), corners));
    points += corners;
  }
  fit.rmse_m = std::sqrt(best.cost / points);
  return fit;
}

}  // namespace sextant
