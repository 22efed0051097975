// SPDX-License-Identifier: Apache-2.0
#include "eval/judge_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "solvers/corner_order.h"
#include "solvers/kabsch.h"

namespace sextant {
namespace {

constexpr int kMaxStarts = 512;  // Enough for eight boards; more views share the same answer.
constexpr int kMaxRounds = 20;
constexpr double kFarBetter = 0.5;  // Of the RMSE as given.
constexpr double kMinMisfit = 0.1;  // Of the mean edge: noise alone does not swap corners.
constexpr double kMaxMisfit = 0.2;  // Of the mean edge: beyond, no order is the right one.

using Assignment = std::vector<int>;  // By camera point: the pair whose LiDAR point belongs to it.

// Four turns, each seen from the front or from behind.
std::array<CornerOrder, 8> EveryOrder() {
  std::array<CornerOrder, 8> orders;
  for (int first = 0; first < kCornersPerBoard; ++first) {
    orders[static_cast<std::size_t>(first)] = {first, false};
    orders[static_cast<std::size_t>(first + kCornersPerBoard)] = {first, true};
  }
  return orders;
}

struct Fit {
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

  Fit FitAll(const Assignment& assignment) const {
    std::vector<Eigen::Vector3d> in_cam;
    std::vector<Eigen::Vector3d> in_lidar;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      in_cam.push_back(pairs_[i].point_in_cam);
      in_lidar.push_back(pairs_[static_cast<std::size_t>(assignment[i])].point_in_lidar);
    }
    return FitPoints(in_cam, in_lidar);
  }

  // Every pose worth starting from: one order for all boards, then board against board.
  std::vector<Rigid3d> Starts() const {
    std::vector<Rigid3d> starts;
    for (const CornerOrder& order : EveryOrder()) {
      Assignment assignment = AsGiven();
      for (const BoardPairs& group : groups_) Assign(group, group, order, assignment);
      AddStart(FitAll(assignment), starts);
    }
    for (const auto& [view, members] : views_) {
      for (const BoardPairs* in_cam : members) {
        for (const BoardPairs* in_lidar : members) {
          for (const CornerOrder& order : EveryOrder()) {
            if (static_cast<int>(starts.size()) >= kMaxStarts) return starts;
            AddStart(FitBoard(*in_cam, *in_lidar, order), starts);
          }
        }
      }
    }
    return starts;
  }

  Assignment Converge(const Rigid3d& start) const {
    Assignment assignment = AssignUnder(start);
    for (int round = 0; round < kMaxRounds; ++round) {
      Assignment next = AssignUnder(FitAll(assignment).cam_from_lidar);
      if (next == assignment) break;
      assignment = std::move(next);
    }
    return assignment;
  }

  bool SwapsBoards(const Assignment& assignment) const {
    return std::any_of(groups_.begin(), groups_.end(), [&](const BoardPairs& group) {
      const auto& own = group.pairs;
      return std::find(own.begin(), own.end(), assignment[group.pair(0)]) == own.end();
    });
  }

 private:
  static Fit FitPoints(std::span<const Eigen::Vector3d> in_cam,
                       std::span<const Eigen::Vector3d> in_lidar) {
    const Expected<KabschFit> fit = FitKabsch(in_cam, in_lidar);
    if (!fit) return {};
    return {fit->b_from_a, std::sqrt(fit->sum_squares / static_cast<double>(in_cam.size()))};
  }

  Fit FitBoard(const BoardPairs& in_cam, const BoardPairs& in_lidar,
               const CornerOrder& order) const {
    std::array<Eigen::Vector3d, kCornersPerBoard> cam;
    std::array<Eigen::Vector3d, kCornersPerBoard> lidar;
    for (int i = 0; i < kCornersPerBoard; ++i) {
      const auto k = static_cast<std::size_t>(i);
      cam[k] = pairs_[in_cam.pair(i)].point_in_cam;
      lidar[k] = pairs_[in_lidar.pair(order.IndexInA(i, kCornersPerBoard))].point_in_lidar;
    }
    return FitPoints(cam, lidar);
  }

  static void AddStart(const Fit& fit, std::vector<Rigid3d>& starts) {
    if (std::isfinite(fit.rmse_m)) starts.push_back(fit.cam_from_lidar);
  }

  static void Assign(const BoardPairs& in_cam, const BoardPairs& in_lidar, const CornerOrder& order,
                     Assignment& assignment) {
    for (int i = 0; i < kCornersPerBoard; ++i) {
      assignment[in_cam.pair(i)] =
          static_cast<int>(in_lidar.pair(order.IndexInA(i, kCornersPerBoard)));
    }
  }

  struct Match {
    double squares = 0.0;
    const BoardPairs* in_cam = nullptr;
    const BoardPairs* in_lidar = nullptr;
    CornerOrder order;
  };

  Match BestMatch(const Rigid3d& pose, const BoardPairs& in_cam, const BoardPairs& in_lidar) const {
    CornerGroup corners;
    for (int i = 0; i < kCornersPerBoard; ++i) {
      corners.in_b.push_back(pairs_[in_cam.pair(i)].point_in_cam);
      corners.in_a.push_back(pairs_[in_lidar.pair(i)].point_in_lidar);
    }
    Match match{0.0, &in_cam, &in_lidar, BestCornerOrder(corners, pose)};
    for (int i = 0; i < kCornersPerBoard; ++i) {
      const auto k = static_cast<std::size_t>(match.order.IndexInA(i, kCornersPerBoard));
      match.squares +=
          (corners.in_b[static_cast<std::size_t>(i)] - pose * corners.in_a[k]).squaredNorm();
    }
    return match;
  }

  // Boards are far apart against a sensible pose's error, so nearest first settles them.
  Assignment AssignUnder(const Rigid3d& pose) const {
    Assignment assignment = AsGiven();
    for (const auto& [view, members] : views_) {
      std::vector<Match> matches;
      for (const BoardPairs* in_cam : members) {
        for (const BoardPairs* in_lidar : members) {
          matches.push_back(BestMatch(pose, *in_cam, *in_lidar));
        }
      }
      std::stable_sort(matches.begin(), matches.end(),
                       [](const Match& a, const Match& b) { return a.squares < b.squares; });
      std::vector<const BoardPairs*> taken_in_cam;
      std::vector<const BoardPairs*> taken_in_lidar;
      const auto contains = [](const auto& taken, const BoardPairs* group) {
        return std::find(taken.begin(), taken.end(), group) != taken.end();
      };
      for (const Match& match : matches) {
        if (contains(taken_in_cam, match.in_cam) || contains(taken_in_lidar, match.in_lidar)) {
          continue;
        }
        taken_in_cam.push_back(match.in_cam);
        taken_in_lidar.push_back(match.in_lidar);
        Assign(*match.in_cam, *match.in_lidar, match.order, assignment);
      }
    }
    return assignment;
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
  for (const Rigid3d& start : search.Starts()) {
    Assignment assignment = search.Converge(start);
    const double rmse = search.FitAll(assignment).rmse_m;
    // A later start must be better by more than rounding, so that equals do not flip.
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
