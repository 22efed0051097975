// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rectangle_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "features/lidar/rectangle_refine.h"
#include "features/lidar/rectangle_starts.h"
#include "geometry/board_check.h"

namespace sextant {
namespace {

constexpr int kIterations = 12;
constexpr std::size_t kStarts = 12;
constexpr int kFirstIterations = 4;
// Wide, because the starts are a few centimetres off.
constexpr double kFirstReach = 25.0;
constexpr double kEquallyLikely = 9.2;  // -2 ln(0.01): likelihood ratio of 1 %.
constexpr double kSameAngle_rad = 0.02;
constexpr double kSamePlace_m = 0.01;

struct Candidate {
  RectanglePlacement placement = RectanglePlacement::Zero();
  double cost = 0.0;

  void Improve(std::span<const EdgePoint> edges, const Board& board, int iterations, double reach) {
    cost = ImprovePlacement(edges, board, iterations, reach, placement);
  }
};

bool IsSamePlacement(const RectangleFit& a, const RectangleFit& b) {
  return std::abs(a.angle_rad - b.angle_rad) < kSameAngle_rad &&
         (a.center - b.center).norm() < kSamePlace_m;
}

// Those by the outline, turned every way that it allows and the openings distinguish, and the given
// ones.
std::vector<Eigen::Vector3d> AllStarts(std::span<const EdgePoint> edges, const Board& board,
                                       const Eigen::Vector2d& half,
                                       std::span<const Eigen::Vector3d> given) {
  std::vector<Eigen::Vector3d> starts = RectangleStarts(edges, half, kStarts);
  const std::size_t count = starts.size();
  for (int turns = 1; turns < 4; ++turns) {
    const bool is_allowed = turns == 2 || IsSquare(half);
    const bool is_as_one = turns == 3 && HolesAllowTurns(board, 2);
    if (!is_allowed || is_as_one || HolesAllowTurns(board, turns)) continue;
    const Eigen::Vector3d turn(0.0, 0.0, 0.5 * std::numbers::pi * turns);
    for (std::size_t i = 0; i < count; ++i) starts.push_back(starts[i] + turn);
  }
  starts.insert(starts.end(), given.begin(), given.end());
  return starts;
}

}  // namespace

std::vector<RectangleFit> FitRectangles(std::span<const EdgePoint> edges, const Board& board,
                                        std::size_t max_count,
                                        std::span<const Eigen::Vector3d> starts) {
  std::vector<RectangleFit> fits;
  if (static_cast<int>(edges.size()) < kMinEdgesOfFit) return fits;
  const Eigen::Vector2d half(0.5 * board.top_right_m, 0.5 * board.right_bottom_m);
  std::vector<Candidate> candidates;
  for (const Eigen::Vector3d& start : AllStarts(edges, board, half, starts)) {
    Candidate candidate{.placement = {start.x(), start.y(), start.z(), 0.0}};
    candidate.Improve(edges, board, kFirstIterations, kFirstReach);
    candidates.push_back(candidate);
  }
  std::ranges::sort(candidates, {}, &Candidate::cost);
  for (Candidate& candidate : candidates) {
    if (fits.size() >= max_count) break;
    candidate.Improve(edges, board, kIterations, kReachOfFit);
    const std::optional<RectangleFit> fit =
        FinishPlacement(edges, board, candidate.placement, candidate.cost);
    if (!fit) continue;
    const bool is_new = std::ranges::none_of(
        fits, [&](const RectangleFit& other) { return IsSamePlacement(other, *fit); });
    if (is_new) fits.push_back(*fit);
  }
  std::ranges::stable_sort(fits, {}, &RectangleFit::cost);
  return fits;
}

std::size_t MostUpright(std::span<const RectangleFit> fits, const Board& board) {
  const double corner_up = AngleWithCornerUp(board);
  const auto best = std::ranges::min_element(fits, {}, &RectangleFit::cost);
  const double unit = std::max(1.0, best->cost / static_cast<double>(best->sides.size()));
  auto chosen = best;
  for (auto it = fits.begin(); it != fits.end(); ++it) {
    if (it->cost - best->cost > kEquallyLikely * unit) continue;
    if (std::abs(it->angle_rad - corner_up) < std::abs(chosen->angle_rad - corner_up)) chosen = it;
  }
  return static_cast<std::size_t>(chosen - fits.begin());
}

std::optional<RectangleFit> FitRectangle(std::span<const EdgePoint> edges, const Board& board,
                                         std::span<const Eigen::Vector3d> starts) {
  constexpr std::size_t kCompared = 4;
  std::vector<RectangleFit> fits = FitRectangles(edges, board, kCompared, starts);
  if (fits.empty()) return std::nullopt;
  return fits[MostUpright(fits, board)];
}

std::optional<RectangleFit> RefineRectangle(std::span<const EdgePoint> edges, const Board& board,
                                            const Eigen::Vector2d& center, double angle_rad) {
  if (static_cast<int>(edges.size()) < kMinEdgesOfFit) return std::nullopt;
  Candidate candidate{.placement = {center.x(), center.y(), angle_rad, 0.0}};
  candidate.Improve(edges, board, kIterations, kReachOfFit);
  return FinishPlacement(edges, board, candidate.placement, candidate.cost);
}

}  // namespace sextant