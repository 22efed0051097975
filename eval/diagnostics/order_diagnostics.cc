// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/order_diagnostics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "solvers/kernels/kabsch.h"
#include "solvers/matching/corner_order.h"
#include "solvers/matching/object_match.h"

namespace sextant {
namespace {

constexpr double kFarBetter = 0.5;  // Relative to the RMSE of the given order.
// Relative to the mean edge: below it, noise explains the misfit.
constexpr double kMinMisfit = 0.1;
constexpr double kMaxMisfit = 0.2;  // Relative to the mean edge: above it, no order is right.

// For each camera point, the pair whose LiDAR point belongs to it.
using Assignment = std::vector<int>;

// Four rotations in the plane, each seen from the front or from behind.
std::array<CornerOrder, 8> EveryOrder() {
  std::array<CornerOrder, 8> orders;
  for (int first = 0; first < kCornersPerBoard; ++first) {
    orders[static_cast<std::size_t>(first)] = {first, false};
    orders[static_cast<std::size_t>(first + kCornersPerBoard)] = {first, true};
  }
  return orders;
}

struct OrderFit {
  Rigid3d cam_from_lidar;
  double rmse_m = std::numeric_limits<double>::infinity();
};

class OrderSearch {
 public:
  explicit OrderSearch(std::span<const Pair3d3d> pairs)
      : pairs_(pairs), groups_(CompleteBoards(pairs)) {
    for (const BoardPairs& group : groups_) {
      auto& members = views_[group.view];
      members.push_back(&group);
    }
  }

  bool HasGroups() const { return !groups_.empty(); }

  Assignment AsGiven() const {
    Assignment identity(pairs_.size());
    std::iota(identity.begin(), identity.end(), 0);
    return identity;
  }

  double MeanEdge() const {
    double sum = 0.0;
    for (const BoardPairs& group : groups_) {
      for (int i = 0; i < kCornersPerBoard; ++i) {
        const Pair3d3d& from = pairs_[group.pair(i)];
        const Pair3d3d& to = pairs_[group.pair((i + 1) % kCornersPerBoard)];
        sum += (to.point_in_cam - from.point_in_cam).norm();
      }
    }
    return sum / static_cast<double>(kCornersPerBoard * groups_.size());
  }

  OrderFit FitAll(const Assignment& assignment) const {
    std::vector<Eigen::Vector3d> in_cam;
    std::vector<Eigen::Vector3d> in_lidar;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      in_cam.push_back(pairs_[i].point_in_cam);
      in_lidar.push_back(pairs_[static_cast<std::size_t>(assignment[i])].point_in_lidar);
    }
    return FitPoints(in_cam, in_lidar);
  }

  // The assignments that belong to every distinct pose that explains all views. The starts are the
  // fits of one common order for all boards.
  std::vector<Assignment> Explanations() const {
    std::vector<MatchView> match_views;
    std::vector<std::vector<Pairing>> meanings;
    for (const auto& [view, members] : views_) {
      match_views.emplace_back();
      meanings.emplace_back();
      for (const BoardPairs* in_cam : members) {
        for (const BoardPairs* in_lidar : members) {
          AddPairings(members, *in_cam, *in_lidar, match_views.back(), meanings.back());
        }
      }
    }
    MatchOptions options;
    for (const CornerOrder& order : EveryOrder()) {
      Assignment assignment = AsGiven();
      for (const BoardPairs& group : groups_) Assign(group, group, order, assignment);
      const OrderFit fit = FitAll(assignment);
      if (std::isfinite(fit.rmse_m)) options.starts.push_back(fit.cam_from_lidar);
    }
    const auto found = MatchObjects(match_views, options);
    std::vector<Assignment> assignments;
    if (!found) return assignments;
    for (const MatchExplanation& explanation : *found) {
      Assignment assignment = AsGiven();
      for (const TakenPairing& taken : explanation.taken) {
        const Pairing& pairing = meanings[taken.view][taken.pairing];
        Assign(*pairing.in_cam, *pairing.in_lidar, pairing.order, assignment);
      }
      assignments.push_back(std::move(assignment));
    }
    return assignments;
  }

  bool SwapsBoards(const Assignment& assignment) const {
    return std::any_of(groups_.begin(), groups_.end(), [&](const BoardPairs& group) {
      const auto& own = group.pairs;
      return std::find(own.begin(), own.end(), assignment[group.pair(0)]) == own.end();
    });
  }

 private:
  static OrderFit FitPoints(std::span<const Eigen::Vector3d> in_cam,
                            std::span<const Eigen::Vector3d> in_lidar) {
    const Expected<KabschFit> fit = FitKabsch(in_cam, in_lidar);
    if (!fit) return {};
    return {fit->b_from_a, std::sqrt(fit->sum_squares / static_cast<double>(in_cam.size()))};
  }

  struct Pairing {
    const BoardPairs* in_cam = nullptr;
    const BoardPairs* in_lidar = nullptr;
    CornerOrder order;
  };

  // One board's camera corners with another's LiDAR corners, in every order.
  void AddPairings(const std::vector<const BoardPairs*>& members, const BoardPairs& in_cam,
                   const BoardPairs& in_lidar, MatchView& view,
                   std::vector<Pairing>& meanings) const {
    const auto place = [&](const BoardPairs& board) {
      return static_cast<int>(std::find(members.begin(), members.end(), &board) - members.begin());
    };
    for (const CornerOrder& order : EveryOrder()) {
      ObjectPairing pairing{.in_b = place(in_cam), .in_a = place(in_lidar)};
      for (int i = 0; i < kCornersPerBoard; ++i) {
        pairing.points_in_b.push_back(pairs_[in_cam.pair(i)].point_in_cam);
        pairing.points_in_a.push_back(
            pairs_[in_lidar.pair(order.IndexInA(i, kCornersPerBoard))].point_in_lidar);
      }
      view.pairings.push_back(std::move(pairing));
      meanings.push_back({&in_cam, &in_lidar, order});
    }
  }

  static void Assign(const BoardPairs& in_cam, const BoardPairs& in_lidar, const CornerOrder& order,
                     Assignment& assignment) {
    for (int i = 0; i < kCornersPerBoard; ++i) {
      assignment[in_cam.pair(i)] =
          static_cast<int>(in_lidar.pair(order.IndexInA(i, kCornersPerBoard)));
    }
  }

  std::span<const Pair3d3d> pairs_;
  std::vector<BoardPairs> groups_;
  std::map<int, std::vector<const BoardPairs*>> views_;
};

}  // namespace

std::vector<BoardPairs> CompleteBoards(std::span<const Pair3d3d> pairs) {
  std::map<std::pair<int, int>, std::vector<int>> by_board;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    by_board[{pairs[i].id.view, pairs[i].id.board}].push_back(static_cast<int>(i));
  }
  std::vector<BoardPairs> groups;
  for (const auto& [key, members] : by_board) {
    BoardPairs group{key.first, {-1, -1, -1, -1}};
    for (const int i : members) {
      const int corner = pairs[static_cast<std::size_t>(i)].id.corner;
      if (corner >= 0 && corner < kCornersPerBoard) {
        group.pairs[static_cast<std::size_t>(corner)] = i;
      }
    }
    const bool complete = members.size() == kCornersPerBoard &&
                          std::count(group.pairs.begin(), group.pairs.end(), -1) == 0;
    if (complete) groups.push_back(group);
  }
  return groups;
}

std::optional<OrderFinding> FindBetterOrder(std::span<const Pair3d3d> pairs) {
  const OrderSearch search(pairs);
  if (!search.HasGroups()) return std::nullopt;
  const double as_given = search.FitAll(search.AsGiven()).rmse_m;
  if (as_given < kMinMisfit * search.MeanEdge()) return std::nullopt;

  Assignment best;
  double best_rmse = std::min(kFarBetter * as_given, kMaxMisfit * search.MeanEdge());
  for (Assignment& assignment : search.Explanations()) {
    const double rmse = search.FitAll(assignment).rmse_m;
    // Improvements within rounding are ignored, so that ties do not depend on rounding.
    if (rmse < best_rmse * (1.0 - 1e-9)) {
      best_rmse = rmse;
      best = std::move(assignment);
    }
  }
  if (best.empty()) return std::nullopt;
  OrderFinding finding;
  finding.rmse_as_given_m = as_given;
  finding.rmse_reordered_m = best_rmse;
  finding.boards_swapped = search.SwapsBoards(best);
  for (std::size_t i = 0; i < best.size(); ++i) {
    if (best[i] != static_cast<int>(i)) finding.moved.push_back(pairs[i].id);
  }
  finding.lidar_index = std::move(best);
  return finding;
}

}  // namespace sextant
