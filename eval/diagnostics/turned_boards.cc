// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/turned_boards.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "base/units.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr std::array<int, 7> kAngles_deg = {60, 90, 120, 180, 240, 270, 300};
constexpr std::size_t kMaxOfBoard = 200;
constexpr std::size_t kMaxTurned = 2000;

// The points of one board in its plane, seen by the LiDAR.
struct FlatBoard {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double width_m = 0.0;
  double spacing_m = 0.0;  // Mean distance to the nearest neighbour.
  std::vector<Eigen::Vector2d> points{};
};

std::optional<FlatBoard> FlatBoardOf(std::span<const Eigen::Vector3d> in_lidar,
                                     const std::vector<int>& group) {
  constexpr double kMaxThickness = 0.15;
  const auto n = static_cast<double>(group.size());
  FlatBoard board;
  for (const int i : group) board.middle += in_lidar[static_cast<std::size_t>(i)] / n;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const int i : group) {
    const Eigen::Vector3d from_middle = in_lidar[static_cast<std::size_t>(i)] - board.middle;
    scatter += from_middle * from_middle.transpose() / n;
  }
  const SymmetricEigen<3> eigen = EigenOf<3>(scatter);
  const Eigen::Vector3d extent = eigen.values.cwiseMax(0.0).cwiseSqrt();
  if (!(extent[1] > 0.0) || extent[0] > kMaxThickness * extent[1]) return std::nullopt;
  board.width_m = 2.0 * extent[2];
  Eigen::Vector3d normal = eigen.vectors.col(0);
  if (normal.dot(board.middle) > 0.0) normal = -normal;
  const Eigen::Vector3d right = eigen.vectors.col(2);
  const Eigen::Vector3d up = normal.cross(right);
  for (const int i : group) {
    const Eigen::Vector3d from_middle = in_lidar[static_cast<std::size_t>(i)] - board.middle;
    board.points.emplace_back(right.dot(from_middle), up.dot(from_middle));
  }
  for (std::size_t i = 0; i < board.points.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < board.points.size(); ++j) {
      if (j != i) nearest = std::min(nearest, (board.points[j] - board.points[i]).norm());
    }
    board.spacing_m += nearest / n;
  }
  return board;
}

// The corners of a board of four, `quarters` further around its middle.
std::vector<int> QuarterTurned(const FlatBoard& board, int quarters) {
  std::array<int, 4> ring = {0, 1, 2, 3};
  std::ranges::sort(ring, {}, [&](int i) {
    const Eigen::Vector2d& point = board.points[static_cast<std::size_t>(i)];
    return std::atan2(point.y(), point.x());
  });
  std::vector<int> turned(4);
  for (int k = 0; k < 4; ++k) {
    turned[static_cast<std::size_t>(ring[static_cast<std::size_t>(k)])] =
        ring[static_cast<std::size_t>((k + quarters) % 4)];
  }
  return turned;
}

// For each point the one where it gets by the turn; empty where the board does not look the same.
std::vector<int> Turned(const FlatBoard& board, int angle_deg) {
  constexpr double kMaxMiss = 1.0 / 3.0;
  if (board.points.size() == 4) {
    return angle_deg % 90 == 0 ? QuarterTurned(board, angle_deg / 90) : std::vector<int>();
  }
  const double angle = static_cast<double>(angle_deg) * kRadPerDeg;
  Eigen::Matrix2d rotation;
  rotation << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  std::vector<int> turned;
  std::vector<bool> is_taken(board.points.size(), false);
  for (const Eigen::Vector2d& point : board.points) {
    const Eigen::Vector2d there = rotation * point;
    std::size_t nearest = 0;
    for (std::size_t j = 1; j < board.points.size(); ++j) {
      const bool is_nearer =
          (board.points[j] - there).norm() < (board.points[nearest] - there).norm();
      if (is_nearer) nearest = j;
    }
    const bool is_missed = (board.points[nearest] - there).norm() > kMaxMiss * board.spacing_m;
    if (is_missed || is_taken[nearest]) return {};
    is_taken[nearest] = true;
    turned.push_back(static_cast<int>(nearest));
  }
  return turned;
}

std::vector<std::vector<int>> BoardsOfPairs(const std::vector<PairId>& ids) {
  std::map<std::pair<int, int>, std::vector<int>> by_board;
  std::map<int, std::vector<int>> by_view;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    by_board[{ids[i].view, ids[i].board}].push_back(static_cast<int>(i));
    by_view[ids[i].view].push_back(static_cast<int>(i));
  }
  std::vector<std::vector<int>> groups;
  for (auto& [board, group] : by_board) groups.push_back(std::move(group));
  // A pair beside the board tells its corners apart.
  const auto is_board = [](const std::vector<int>& group) { return group.size() >= 3; };
  if (std::ranges::all_of(groups, is_board)) return groups;
  if (std::ranges::any_of(groups, is_board) || by_view.size() != 1) return {};
  return {by_view.begin()->second};
}

}  // namespace

TurnedBoards TurnBoards(const std::vector<PairId>& ids, std::span<const Eigen::Vector3d> in_lidar) {
  if (ids.size() > kMaxTurned) return {};
  TurnedBoards turned{.groups = BoardsOfPairs(ids)};
  std::vector<FlatBoard> boards;
  for (const std::vector<int>& group : turned.groups) {
    if (group.size() < 3 || group.size() > kMaxOfBoard) return {};
    const std::optional<FlatBoard> board = FlatBoardOf(in_lidar, group);
    if (!board) return {};
    boards.push_back(*board);
    if ((board->middle - boards.front().middle).norm() > board->width_m) return {};
  }
  if (boards.empty()) return {};
  for (const int angle_deg : kAngles_deg) {
    TurnedOrder order{.angle_deg = angle_deg, .lidar_index = std::vector<int>(ids.size())};
    bool looks_same = true;
    for (std::size_t g = 0; g < boards.size() && looks_same; ++g) {
      const std::vector<int>& group = turned.groups[g];
      const std::vector<int> places = Turned(boards[g], angle_deg);
      looks_same = !places.empty();
      for (std::size_t i = 0; i < places.size(); ++i) {
        order.lidar_index[static_cast<std::size_t>(group[i])] =
            group[static_cast<std::size_t>(places[i])];
      }
    }
    if (looks_same) turned.orders.push_back(std::move(order));
  }
  return turned;
}

}  // namespace sextant
