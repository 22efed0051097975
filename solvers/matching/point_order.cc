// SPDX-License-Identifier: Apache-2.0
#include "solvers/matching/point_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "solvers/matching/min_cost_assignment.h"

namespace sextant {
namespace {

using Triple = CorrespondenceModel::Triple;
using Correspondences = std::vector<Correspondence>;

constexpr std::size_t kMaxStarts = 6000;
constexpr std::size_t kMaxScoredGroups = 16;
constexpr std::size_t kMaxFollowed = 96;
constexpr std::size_t kMaxOrders = 24;
constexpr int kMaxOrderRounds = 20;
// Instead of infinity, so that sums and differences stay finite.
constexpr double kUnobservable = 1e12;

std::size_t At(int index) { return static_cast<std::size_t>(index); }

// A lower bound of the cost of every assignment: each point takes the nearest one, from either
// side.
double NearestCost(const std::vector<double>& costs, std::size_t n) {
  double by_cam = 0.0;
  double by_lidar = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    double nearest_lidar = costs[n * i];
    double nearest_cam = costs[i];
    for (std::size_t j = 1; j < n; ++j) {
      nearest_lidar = std::min(nearest_lidar, costs[n * i + j]);
      nearest_cam = std::min(nearest_cam, costs[n * j + i]);
    }
    by_cam += nearest_lidar;
    by_lidar += nearest_cam;
  }
  return std::max(by_cam, by_lidar);
}

bool MayExchange(const OrderView& view) { return view.groups.size() <= kMaxExchangedGroups; }

// The groups whose LiDAR points may belong to a group's camera points.
template <class Visit>
void ForPartners(const OrderView& view, std::size_t group, const Visit& visit) {
  for (std::size_t other = 0; other < view.groups.size(); ++other) {
    const bool is_partner = other == group || (MayExchange(view) && view.groups[other].size() ==
                                                                        view.groups[group].size());
    if (is_partner) visit(other);
  }
}

// The costs of a view's orders under one pose.
class ViewCosts {
 public:
  ViewCosts(const CorrespondenceModel& model, const OrderView& view, const Rigid3d& pose)
      : model_(model), view_(view), predicted_(view.groups.size()) {
    for (std::size_t g = 0; g < view.groups.size(); ++g) {
      for (const int i : view.groups[g]) {
        predicted_[g].push_back(model.Predict(pose, model.in_lidar()[At(i)]));
      }
    }
  }

  // A lower bound of the sum of squares of every order.
  double Bound() {
    double sum = 0.0;
    for (std::size_t g = 0; g < view_.groups.size(); ++g) {
      double best = std::numeric_limits<double>::infinity();
      ForPartners(view_, g, [&](std::size_t other) {
        Fill(g, other);
        best = std::min(best, NearestCost(costs_, view_.groups[g].size()));
      });
      sum += best;
    }
    return sum;
  }

  // Appends the best correspondences.
  void Assign(Correspondences& correspondences) {
    const std::vector<std::size_t> partners = Partners();
    for (std::size_t g = 0; g < view_.groups.size(); ++g) {
      const PointGroup& cam = view_.groups[g];
      const PointGroup& lidar = view_.groups[partners[g]];
      const MinCostAssignment best = Within(g, partners[g]);
      for (std::size_t i = 0; i < cam.size(); ++i) {
        correspondences.push_back({cam[i], lidar[At(best.column_of_row[i])]});
      }
    }
  }

 private:
  double SquaredDistance(int cam, const std::optional<Eigen::Vector3d>& predicted) const {
    if (!predicted) return kUnobservable;
    return std::min(kUnobservable, (model_.observed()[At(cam)] - *predicted).squaredNorm());
  }

  // costs_[n * i + j]: squared distance of camera point i of one group to LiDAR point j of another.
  void Fill(std::size_t cam, std::size_t lidar) {
    const PointGroup& group = view_.groups[cam];
    const std::size_t n = group.size();
    costs_.resize(n * n);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        costs_[n * i + j] = SquaredDistance(group[i], predicted_[lidar][j]);
      }
    }
  }

  MinCostAssignment Within(std::size_t cam, std::size_t lidar) {
    Fill(cam, lidar);
    return AssignAtMinCost(costs_, static_cast<int>(view_.groups[cam].size()));
  }

  std::vector<std::size_t> Partners() {
    const std::size_t n = view_.groups.size();
    std::vector<std::size_t> partners(n);
    std::iota(partners.begin(), partners.end(), 0U);
    if (n == 1 || !MayExchange(view_)) return partners;
    std::vector<double> costs(n * n, kUnobservable * kMaxOrderedPoints);
    for (std::size_t g = 0; g < n; ++g) {
      ForPartners(view_, g,
                  [&](std::size_t other) { costs[n * g + other] = Within(g, other).cost; });
    }
    const MinCostAssignment best = AssignAtMinCost(costs, static_cast<int>(n));
    for (std::size_t g = 0; g < n; ++g) partners[g] = At(best.column_of_row[g]);
    return partners;
  }

  const CorrespondenceModel& model_;
  const OrderView& view_;
  std::vector<std::vector<std::optional<Eigen::Vector3d>>> predicted_;
  std::vector<double> costs_;
};

// Twice the area of the triangle of three camera points.
double AreaOf(const CorrespondenceModel& model, const Triple& t) {
  const auto& points = model.observed();
  return (points[At(t[1])] - points[At(t[0])]).cross(points[At(t[2])] - points[At(t[0])]).norm();
}

// The largest triangle of a group's camera points without the point `without`.
Triple LargestTriangle(const CorrespondenceModel& model, const PointGroup& group, int without) {
  Triple best = {group[0], group[1], group[2]};
  double area = -1.0;
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (std::size_t j = i + 1; j < group.size(); ++j) {
      for (std::size_t k = j + 1; k < group.size(); ++k) {
        const Triple triple = {group[i], group[j], group[k]};
        if (std::ranges::count(triple, without) > 0) continue;
        const double here = AreaOf(model, triple);
        if (here <= area) continue;
        area = here;
        best = triple;
      }
    }
  }
  return best;
}

// Calls `visit` with every ordered triple of a group.
template <class Visit>
void ForTriples(const PointGroup& group, const Visit& visit) {
  for (const int a : group) {
    for (const int b : group) {
      for (const int c : group) {
        if (a != b && a != c && b != c) visit(Triple{a, b, c});
      }
    }
  }
}

class OrderSearch {
 public:
  OrderSearch(const CorrespondenceModel& model, std::span<const OrderView> views)
      : model_(model), views_(views), in_group_(model.size(), false) {
    for (const OrderView& view : views) {
      for (const PointGroup& group : view.groups) {
        for (const int i : group) in_group_[At(i)] = true;
      }
    }
    // The first views, spread evenly, that have as many groups as are scored.
    const std::size_t step = std::max<std::size_t>(1, views.size() / kMaxScoredGroups);
    std::size_t scored = 0;
    for (std::size_t i = 0; i < views.size() && scored < kMaxScoredGroups; i += step) {
      scored_.push_back(Truncated(views[i], kMaxScoredGroups - scored));
      scored += scored_.back().groups.size();
    }
  }

  std::vector<PointOrder> Run() const {
    const std::vector<Rigid3d> starts = Ranked(Starts());
    std::vector<std::pair<double, Followed>> found;
    for (const Rigid3d& start : starts) {
      std::optional<Followed> followed = Follow(start, scored_, false);
      if (!followed) continue;
      const bool is_new = std::ranges::none_of(found, [&](const auto& other) {
        return other.second.correspondences == followed->correspondences;
      });
      if (is_new) found.emplace_back(followed->fit.sum_squares, std::move(*followed));
    }
    std::ranges::stable_sort(found, {}, [](const auto& f) { return f.first; });
    if (found.size() > kMaxOrders) found.resize(kMaxOrders);
    std::vector<PointOrder> orders;
    for (const auto& [squares, followed] : found) {
      AddOrder(Follow(followed.fit.cam_from_lidar, views_, true), orders);
    }
    std::ranges::stable_sort(orders, {}, &PointOrder::rmse);
    return orders;
  }

 private:
  struct Followed {
    Correspondences correspondences;
    CorrespondenceFit fit;
  };

  // A view of more groups than are scored keeps the first of them; these then keep their places.
  static OrderView Truncated(const OrderView& view, std::size_t groups) {
    OrderView kept = view;
    if (kept.groups.size() > groups && !MayExchange(view)) kept.groups.resize(groups);
    return kept;
  }

  // Every pose that one triangle of a group's camera points allows, within the budget.
  void AddStarts(const OrderView& view, std::size_t group, const Triple& triangle,
                 std::size_t& budget, std::vector<Rigid3d>& starts) const {
    ForPartners(view, group, [&](std::size_t other) {
      ForTriples(view.groups[other], [&](const Triple& lidar) {
        if (budget == 0) return;
        --budget;
        model_.AddPosesOf(triangle, lidar, starts);
      });
    });
  }

  std::vector<Rigid3d> Starts() const {
    std::vector<Rigid3d> starts;
    std::size_t budget = kMaxStarts;
    for (const OrderView& view : scored_) {
      for (std::size_t g = 0; g < view.groups.size() && budget > 0; ++g) {
        const PointGroup& group = view.groups[g];
        const Triple first = LargestTriangle(model_, group, -1);
        AddStarts(view, g, first, budget, starts);
        if (group.size() == 3) continue;
        AddStarts(view, g, LargestTriangle(model_, group, first[0]), budget, starts);
      }
    }
    return starts;
  }

  // The most promising starts, best first.
  std::vector<Rigid3d> Ranked(const std::vector<Rigid3d>& starts) const {
    std::vector<std::pair<double, std::size_t>> ranked;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      double bound = 0.0;
      for (const OrderView& view : scored_) bound += ViewCosts(model_, view, starts[i]).Bound();
      ranked.emplace_back(bound, i);
    }
    std::ranges::sort(ranked);
    std::vector<Rigid3d> best;
    for (const auto& [bound, index] : ranked) {
      if (best.size() == kMaxFollowed) break;
      best.push_back(starts[index]);
    }
    return best;
  }

  Correspondences Assigned(const Rigid3d& pose, std::span<const OrderView> views,
                           bool with_others) const {
    Correspondences correspondences;
    for (const OrderView& view : views) ViewCosts(model_, view, pose).Assign(correspondences);
    for (std::size_t i = 0; with_others && i < in_group_.size(); ++i) {
      if (!in_group_[i]) correspondences.push_back({static_cast<int>(i), static_cast<int>(i)});
    }
    return correspondences;
  }

  // Assigns and fits in turns until the assignment does not change.
  std::optional<Followed> Follow(const Rigid3d& start, std::span<const OrderView> views,
                                 bool with_others) const {
    Followed best{.correspondences = {}, .fit = {.cam_from_lidar = start}};
    for (int round = 0; round < kMaxOrderRounds; ++round) {
      Correspondences next = Assigned(best.fit.cam_from_lidar, views, with_others);
      if (next == best.correspondences) break;
      const auto fit = model_.Fit(next, best.fit.cam_from_lidar);
      if (!fit) return std::nullopt;
      best = {std::move(next), *fit};
    }
    return best;
  }

  void AddOrder(const std::optional<Followed>& followed, std::vector<PointOrder>& orders) const {
    if (!followed) return;
    PointOrder order{
        .lidar_index = std::vector<int>(model_.size()),
        .cam_from_lidar = followed->fit.cam_from_lidar,
        .rmse = std::sqrt(followed->fit.sum_squares / static_cast<double>(model_.size()))};
    for (const Correspondence& c : followed->correspondences)
      order.lidar_index[At(c.cam)] = c.lidar;
    const auto is_same = [&](const PointOrder& o) { return o.lidar_index == order.lidar_index; };
    if (std::ranges::none_of(orders, is_same)) orders.push_back(std::move(order));
  }

  const CorrespondenceModel& model_;
  std::span<const OrderView> views_;
  std::vector<bool> in_group_;
  std::vector<OrderView> scored_;
};

}  // namespace

std::vector<PointOrder> FindPointOrders(const CorrespondenceModel& model,
                                        std::span<const OrderView> views) {
  if (views.empty()) return {};
  return OrderSearch(model, views).Run();
}

std::optional<PointOrder> FitGivenOrder(const CorrespondenceModel& model) {
  const int n = static_cast<int>(model.size());
  if (n < 3) return std::nullopt;
  Correspondences given;
  for (int i = 0; i < n; ++i) given.push_back({i, i});
  std::vector<Rigid3d> starts;
  if (model.dimension() == 3) starts.emplace_back();
  // For pixels, triples that are spread over the list; any of them may contain an outlier.
  constexpr int kTriples = 12;
  for (int i = 0; model.dimension() == 2 && i < std::min(n, kTriples); ++i) {
    const int first = i * n / std::min(n, kTriples);
    const Triple triple = {first, (first + n / 3) % n, (first + 2 * n / 3) % n};
    model.AddPosesOf(triple, triple, starts);
  }
  std::optional<CorrespondenceFit> best;
  for (const Rigid3d& start : starts) {
    const auto fit = model.Fit(given, start);
    if (fit && (!best || fit->sum_squares < best->sum_squares)) best = fit;
  }
  if (!best) return std::nullopt;
  PointOrder order{.lidar_index = {},
                   .cam_from_lidar = best->cam_from_lidar,
                   .rmse = std::sqrt(best->sum_squares / n)};
  for (int i = 0; i < n; ++i) order.lidar_index.push_back(i);
  return order;
}

}  // namespace sextant
