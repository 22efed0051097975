// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/order_diagnostics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <tuple>

#include "base/units.h"
#include "eval/diagnostics/f_test.h"
#include "eval/diagnostics/facing.h"
#include "eval/diagnostics/turned_boards.h"
#include "solvers/matching/point_order.h"

namespace sextant {
namespace {

constexpr double kFarBetter = 0.5;  // Relative to the RMSE of the given order.
// Relative to the distance between neighbours: below it, noise explains the misfit.
constexpr double kMinMisfit = 0.1;
constexpr double kMaxMisfit = 0.2;  // The same: above it, no order is right.
constexpr double kAboutEqual = 1.5;
constexpr double kDecisive = 9.2;     // -2 ln(0.01): likelihood ratio of 1 %.
constexpr double kNegligible = 1e-3;  // Relative to the distance between neighbours.

// How a camera is mounted by a pose.
struct Mounting {
  double tilt_deg = 0.0;  // Between the camera's y axis, which is down, and the LiDAR's -z.
  double apart_m = 0.0;   // Between the sensors.
};

Mounting MountingBy(const Rigid3d& cam_from_lidar) {
  const double down = -cam_from_lidar.rotation.toRotationMatrix()(1, 2);
  return {std::acos(std::clamp(down, -1.0, 1.0)) * kDegPerRad,
          cam_from_lidar.Inverse().translation.norm()};
}

// Why nobody mounts a camera so, if it may as well be mounted the other way; empty if one may.
std::string WhyUnlikely(const Mounting& given, const Mounting& other, double range_m) {
  constexpr double kUpright_deg = 30.0;
  constexpr double kOnItsSide_deg = 60.0;
  constexpr double kUpsideDown_deg = 90.0;
  constexpr double kFar = 0.25;  // Relative to the distance of the board.
  if (other.tilt_deg > kUpright_deg || given.apart_m < other.apart_m) return {};
  const bool is_far = given.apart_m > std::max(kFar * range_m, 2.0 * other.apart_m);
  const bool is_upside_down = given.tilt_deg > kUpsideDown_deg;
  if (!is_upside_down && !(is_far && given.tilt_deg > kOnItsSide_deg)) return {};
  return fmt::format(
      "as given the camera would be {} and {:.2f} m from the LiDAR; with this order it is upright "
      "and {:.2f} m from it",
      is_upside_down ? "upside down" : "on its side", given.apart_m, other.apart_m);
}

std::size_t At(int index) { return static_cast<std::size_t>(index); }

std::vector<PairId> IdsOf(const CalibrationProblem& problem, bool in_pixels) {
  std::vector<PairId> ids;
  for (const Pair3d3d& pair : problem.pairs_3d3d) {
    if (!in_pixels) ids.push_back(pair.id);
  }
  for (const Pair2d3d& pair : problem.pairs_2d3d) {
    if (in_pixels) ids.push_back(pair.id);
  }
  return ids;
}

// The groups within which points may be in any order.
struct Grouping {
  std::vector<OrderView> views;
  std::size_t largest = 0;      // Points in the largest group, examined or not.
  std::size_t most_boards = 0;  // Groups in one view.

  void Add(OrderView& view, PointGroup group, std::size_t min_points) {
    largest = std::max(largest, group.size());
    if (group.size() < min_points || group.size() > kMaxOrderedPoints) return;
    view.groups.push_back(std::move(group));
    most_boards = std::max(most_boards, view.groups.size());
  }
};

Grouping GroupByBoard(const std::vector<PairId>& ids) {
  std::map<int, std::map<int, PointGroup>> views;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    views[ids[i].view][ids[i].board].push_back(static_cast<int>(i));
  }
  Grouping grouping;
  for (auto& [view, boards] : views) {
    OrderView members;
    for (auto& [board, group] : boards) grouping.Add(members, std::move(group), 3);
    if (!members.groups.empty()) grouping.views.push_back(std::move(members));
  }
  return grouping;
}

Grouping GroupByView(const std::vector<PairId>& ids, std::size_t min_points) {
  std::map<int, PointGroup> views;
  for (std::size_t i = 0; i < ids.size(); ++i) views[ids[i].view].push_back(static_cast<int>(i));
  Grouping grouping;
  for (auto& [view, group] : views) {
    OrderView members;
    grouping.Add(members, std::move(group), min_points);
    if (!members.groups.empty()) grouping.views.push_back(std::move(members));
  }
  return grouping;
}

class OrderJudge {
 public:
  OrderJudge(const CalibrationProblem& problem, bool in_pixels)
      : problem_(problem),
        in_pixels_(in_pixels),
        ids_(IdsOf(problem, in_pixels)),
        model_(in_pixels ? ModelOf(problem.pairs_2d3d, *problem.camera)
                         : ModelOf(problem.pairs_3d3d)) {}

  OrderDiagnosis Diagnose() {
    const std::optional<PointOrder> given = FitGivenOrder(*model_);
    OrderDiagnosis diagnosis = Search(given);
    const bool is_found = diagnosis.better || !diagnosis.rivals.empty();
    if (given && !diagnosis.faces_as_given && !is_found) JudgeTurned(*given, diagnosis);
    return diagnosis;
  }

 private:
  OrderDiagnosis Search(const std::optional<PointOrder>& given) {
    OrderDiagnosis diagnosis{.in_pixels = in_pixels_};
    const Grouping by_board = GroupByBoard(ids_);
    const Grouping by_view = GroupByView(ids_, in_pixels_ ? 4 : 3);
    if (given) diagnosis.rmse_as_given = given->rmse;
    diagnosis.faces_as_given = given && FacesWith(by_board, by_view, given->cam_from_lidar);
    if (by_board.views.empty() && by_view.views.empty()) {
      diagnosis.not_searched = fmt::format(
          "{} pairs of one board or view may be in any order, and at most {} are examined; state "
          "which pairs belong to which board (columns view, board and corner)",
          std::max(by_board.largest, by_view.largest), kMaxOrderedPoints);
      return diagnosis;
    }
    for (const Grouping* grouping : {&by_board, &by_view}) {
      if (grouping->views.empty()) continue;
      Use(*grouping);
      const double as_given = given ? given->rmse : std::numeric_limits<double>::infinity();
      if (as_given < kMinMisfit * spacing_ && !diagnosis.faces_as_given) break;
      if (grouping->most_boards > kMaxExchangedGroups) {
        diagnosis.not_searched =
            fmt::format("a view has {} boards, and which board is which is examined up to {}",
                        grouping->most_boards, kMaxExchangedGroups);
      }
      Judge(*grouping, as_given, diagnosis);
      if (diagnosis.better || !diagnosis.rivals.empty()) break;
    }
    return diagnosis;
  }

  // Takes the groups' points and the mean distance from a camera point to its nearest neighbour.
  void Use(const Grouping& grouping) {
    groups_in_lidar_.clear();
    double sum = 0.0;
    double count = 0.0;
    for (const OrderView& view : grouping.views) {
      for (const PointGroup& group : view.groups) {
        std::vector<Eigen::Vector3d>& points = groups_in_lidar_.emplace_back();
        for (const int i : group) {
          points.push_back(model_->in_lidar()[At(i)]);
          sum += ToNearest(group, i);
          count += 1.0;
        }
      }
    }
    spacing_ = sum / count;
  }

  double ToNearest(const PointGroup& group, int i) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const int j : group) {
      const double distance = (model_->observed()[At(j)] - model_->observed()[At(i)]).norm();
      // A repeated point is no neighbour.
      if (j != i && distance > 0.0) nearest = std::min(nearest, distance);
    }
    return std::isfinite(nearest) ? nearest : 0.0;
  }

  bool FacesWith(const Grouping& by_board, const Grouping& by_view, const Rigid3d& pose) {
    const Grouping& grouping = by_board.views.empty() ? by_view : by_board;
    if (grouping.views.empty()) return false;
    Use(grouping);
    return SensorsFaceEachOther(groups_in_lidar_, pose);
  }

  void Judge(const Grouping& grouping, double as_given, OrderDiagnosis& diagnosis) const {
    const double most = kMaxMisfit * spacing_;
    std::vector<PointOrder> candidates = FindPointOrders(*model_, grouping.views);
    std::erase_if(candidates, [&](const PointOrder& order) {
      // Where the sensors face each other, not every other order is an improvement.
      const bool is_worse = diagnosis.faces_as_given && order.rmse > as_given / kFarBetter;
      return order.rmse > most || is_worse ||
             SensorsFaceEachOther(groups_in_lidar_, order.cam_from_lidar);
    });
    if (candidates.empty() || IsGiven(candidates.front())) return;
    const PointOrder& best = candidates.front();
    const double equal = EqualUpTo(best.rmse);
    const bool may_be_chance =
        as_given < std::max(best.rmse / kFarBetter, equal) || IsByChance(as_given, best.rmse);
    if (!diagnosis.faces_as_given && may_be_chance) return;
    std::vector<OrderFinding> findings = {FindingOf(best, grouping)};
    for (std::size_t i = 1; i < candidates.size() && candidates[i].rmse <= equal; ++i) {
      if (!HaveSamePose(candidates[i], best))
        findings.push_back(FindingOf(candidates[i], grouping));
    }
    if (findings.size() == 1) {
      diagnosis.better = std::move(findings.front());
    } else {
      diagnosis.rivals = std::move(findings);
    }
  }

  // The poses of turned boards that fit within `most` and differ from the given one, best first.
  std::vector<OrderFinding> FitTurned(const TurnedBoards& boards, const Grouping& grouping,
                                      const PointOrder& given, double most) const {
    std::vector<OrderFinding> findings;
    for (const TurnedOrder& turned : boards.orders) {
      const CalibrationProblem reordered =
          Reordered(problem_, {.in_pixels = in_pixels_, .lidar_index = turned.lidar_index});
      std::optional<PointOrder> fit =
          FitGivenOrder(in_pixels_ ? *ModelOf(reordered.pairs_2d3d, *problem_.camera)
                                   : *ModelOf(reordered.pairs_3d3d));
      if (!fit || fit->rmse > most || HaveSamePose(*fit, given)) continue;
      if (SensorsFaceEachOther(groups_in_lidar_, fit->cam_from_lidar)) continue;
      fit->lidar_index = turned.lidar_index;
      findings.push_back(FindingOf(*fit, grouping));
      findings.back().turned_deg = turned.angle_deg;
    }
    std::ranges::stable_sort(findings, {}, &OrderFinding::rmse);
    return findings;
  }

  // Other corners from which boards at one place may have been listed.
  void JudgeTurned(const PointOrder& given, OrderDiagnosis& diagnosis) {
    constexpr double kMinTurnedMisfit = 0.02;
    constexpr double kAsWell = 3.0;
    const TurnedBoards boards = TurnBoards(ids_, model_->in_lidar());
    if (boards.orders.empty()) return;
    Grouping grouping;
    grouping.views.push_back({.groups = boards.groups});
    Use(grouping);
    const double most = kMaxMisfit * spacing_;
    if (given.rmse > most) return;
    std::vector<OrderFinding> turned = FitTurned(boards, grouping, given, most);
    if (turned.empty()) return;
    const double best = turned.front().rmse;
    if (given.rmse > kMinTurnedMisfit * spacing_ && !IsByChance(given.rmse, best)) {
      std::erase_if(turned, [&](const OrderFinding& o) { return o.rmse > EqualUpTo(best); });
      if (turned.size() == 1) {
        diagnosis.better = std::move(turned.front());
      } else {
        diagnosis.rivals = std::move(turned);
      }
      return;
    }
    const double equal =
        std::min(EqualUpTo(given.rmse), kAsWell * given.rmse + kNegligible * spacing_);
    std::erase_if(turned, [&](const OrderFinding& o) { return o.rmse > equal; });
    const Mounting as_given = MountingBy(given.cam_from_lidar);
    double least_tilt_deg = std::numeric_limits<double>::infinity();
    for (const OrderFinding& order : turned) {
      const Mounting mounting = MountingBy(order.cam_from_lidar);
      const std::string why = WhyUnlikely(as_given, mounting, RangeOf(boards.groups.front()));
      if (why.empty() || mounting.tilt_deg > least_tilt_deg) continue;
      least_tilt_deg = mounting.tilt_deg;
      diagnosis.better = order;
      diagnosis.unlikely_as_given = why;
    }
    diagnosis.turned = std::move(turned);
  }

  double RangeOf(const std::vector<int>& group) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int i : group) sum += model_->in_lidar()[At(i)];
    return sum.norm() / static_cast<double>(group.size());
  }

  static bool IsGiven(const PointOrder& order) {
    for (std::size_t i = 0; i < order.lidar_index.size(); ++i) {
      if (order.lidar_index[i] != static_cast<int>(i)) return false;
    }
    return true;
  }

  double Redundant() const {
    return model_->dimension() * static_cast<double>(model_->size()) - 6.0;
  }

  // Whether one of two right orders may well fit so much worse, by the F-test of their residuals.
  bool IsByChance(double rmse, double best) const {
    constexpr double kChance = 0.005;
    if (!std::isfinite(rmse)) return false;
    const double redundant = std::max(2.0, Redundant());
    return TailOfF(rmse * rmse / std::max(1e-300, best * best), redundant, redundant) > kChance;
  }

  // The RMSE up to which another order fits about as well.
  double EqualUpTo(double rmse) const {
    const double by_chance = std::exp(kDecisive / (2.0 * std::max(1.0, Redundant())));
    return rmse * std::max(kAboutEqual, by_chance) + kNegligible * spacing_;
  }

  // Whether the poses predict the same to within twice the residuals: points so near to each other
  // that their order does not matter.
  bool HaveSamePose(const PointOrder& a, const PointOrder& b) const {
    double squares = 0.0;
    for (const Eigen::Vector3d& point : model_->in_lidar()) {
      const auto by_a = model_->Predict(a.cam_from_lidar, point);
      const auto by_b = model_->Predict(b.cam_from_lidar, point);
      if (!by_a || !by_b) return false;
      squares += (*by_a - *by_b).squaredNorm();
    }
    const double apart = std::sqrt(squares / static_cast<double>(model_->size()));
    return apart < 2.0 * std::max(a.rmse, b.rmse) + kNegligible * spacing_;
  }

  OrderFinding FindingOf(const PointOrder& order, const Grouping& grouping) const {
    OrderFinding finding{.in_pixels = in_pixels_,
                         .rmse = order.rmse,
                         .cam_from_lidar = order.cam_from_lidar,
                         .lidar_index = order.lidar_index};
    for (std::size_t i = 0; i < order.lidar_index.size(); ++i) {
      if (order.lidar_index[i] != static_cast<int>(i)) finding.moved.push_back(ids_[i]);
    }
    for (const OrderView& view : grouping.views) {
      for (const PointGroup& group : view.groups) {
        const int first = order.lidar_index[At(group.front())];
        finding.boards_swapped |= std::ranges::count(group, first) == 0;
      }
    }
    return finding;
  }

  const CalibrationProblem& problem_;
  bool in_pixels_;
  std::vector<PairId> ids_;
  std::unique_ptr<CorrespondenceModel> model_;
  std::vector<std::vector<Eigen::Vector3d>> groups_in_lidar_;
  double spacing_ = 0.0;
};

}  // namespace

OrderDiagnosis DiagnoseOrder(const CalibrationProblem& problem) {
  if (problem.pairs_3d3d.size() >= 3) return OrderJudge(problem, false).Diagnose();
  if (problem.pairs_2d3d.size() >= 4 && problem.camera) return OrderJudge(problem, true).Diagnose();
  OrderDiagnosis diagnosis;
  diagnosis.not_searched =
      "expected at least 3 3D-3D pairs, or 4 2D-3D pairs and the camera (--camera)";
  return diagnosis;
}

std::vector<std::array<int, 2>> ExchangedPairs(const OrderFinding& order) {
  constexpr std::size_t kOf = 4;
  std::vector<std::array<int, 2>> exchanged;
  for (std::size_t i = 0; i < order.lidar_index.size(); ++i) {
    const int other = order.lidar_index[i];
    if (order.lidar_index[At(other)] != static_cast<int>(i)) return {};
    if (other > static_cast<int>(i)) exchanged.push_back({static_cast<int>(i), other});
  }
  if (kOf * order.moved.size() > order.lidar_index.size()) return {};
  std::map<std::pair<int, int>, int> of_board;
  for (const PairId& id : order.moved) {
    if (++of_board[{id.view, id.board}] > 2) return {};
  }
  return exchanged;
}

CalibrationProblem Reordered(const CalibrationProblem& problem, const OrderFinding& order) {
  CalibrationProblem reordered = problem;
  if (order.in_pixels) {
    for (std::size_t i = 0; i < order.lidar_index.size(); ++i) {
      reordered.pairs_2d3d[i].point_in_lidar =
          problem.pairs_2d3d[At(order.lidar_index[i])].point_in_lidar;
    }
    return reordered;
  }
  std::map<std::tuple<int, int, int>, Eigen::Vector3d> by_id;
  for (std::size_t i = 0; i < order.lidar_index.size(); ++i) {
    Pair3d3d& pair = reordered.pairs_3d3d[i];
    pair.point_in_lidar = problem.pairs_3d3d[At(order.lidar_index[i])].point_in_lidar;
    by_id[{pair.id.view, pair.id.board, pair.id.corner}] = pair.point_in_lidar;
  }
  // The 2D-3D pairs of the same corner change with it.
  for (Pair2d3d& pair : reordered.pairs_2d3d) {
    const auto found = by_id.find({pair.id.view, pair.id.board, pair.id.corner});
    if (found != by_id.end()) pair.point_in_lidar = found->second;
  }
  return reordered;
}

}  // namespace sextant
