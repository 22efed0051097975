// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/rival_groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/units.h"
#include "eval/diagnostics/spread_over.h"
#include "eval/diagnostics/without_noise.h"
#include "solvers/core/rivals.h"

namespace sextant {
namespace {

std::vector<double> ResidualsUnder(const CalibrationProblem& problem, const Rigid3d& pose,
                                   bool in_pixels) {
  Evaluation evaluation = Evaluate(problem, pose);
  return in_pixels ? std::move(evaluation.per_pair_px) : std::move(evaluation.per_pair_m);
}

// The pairs within the limit that are nearer to this pose than to the other one.
PairGroup GroupOf(const Rigid3d& pose, const std::vector<double>& own,
                  const std::vector<double>& other, double limit) {
  PairGroup group{.cam_from_lidar = pose, .members = {}, .rmse = 0.0};
  double squares = 0.0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (!(own[i] <= limit) || !(own[i] < other[i])) continue;
    group.members.push_back(static_cast<int>(i));
    squares += own[i] * own[i];
  }
  group.rmse = std::sqrt(squares / std::max(1.0, static_cast<double>(group.members.size())));
  return group;
}

std::string Agreement(const PairGroup& group, bool in_pixels) {
  const Eigen::Vector3d& t = group.cam_from_lidar.translation;
  return fmt::format("to RMSE {} on the translation {:.4f} {:.4f} {:.4f} m",
                     in_pixels ? fmt::format("{:.3g} px", group.rmse)
                               : fmt::format("{:.3g} mm", group.rmse * kMmPerM),
                     t.x(), t.y(), t.z());
}

}  // namespace

std::optional<RivalGroups> FindRivalGroups(const SolverRegistry& registry,
                                           const CalibrationProblem& problem) {
  constexpr std::size_t kMaxSearched = 400;
  const bool in_pixels = problem.pairs_3d3d.empty();
  // Four pixels of eight are explained by any of several poses.
  const std::size_t min_members = in_pixels ? 5 : 4;
  const std::size_t count = in_pixels ? problem.pairs_2d3d.size() : problem.pairs_3d3d.size();
  if (count < 2 * min_members || (in_pixels && !problem.camera)) return std::nullopt;
  CalibrationProblem some;
  some.camera = problem.camera;
  some.pairs_3d3d = SpreadOver(problem.pairs_3d3d, kMaxSearched);
  if (in_pixels) some.pairs_2d3d = SpreadOver(problem.pairs_2d3d, kMaxSearched);
  const CalibrationProblem searched = WithoutNoise(std::move(some));
  const Expected<SolverPtr> solver = registry.Make(in_pixels ? "ransac(p3p)" : "ransac(kabsch)");
  if (!solver) return std::nullopt;
  const Expected<SolveReport> report = (*solver)->Solve(searched);
  if (!report || report->alternatives.empty()) return std::nullopt;
  const std::vector<double> used = ResidualsUnder(searched, report->cam_from_lidar, in_pixels);
  double largest = 0.0;
  for (const int i : report->inliers)
    largest = std::max(largest, used[static_cast<std::size_t>(i)]);
  const std::vector<double> first = ResidualsUnder(problem, report->cam_from_lidar, in_pixels);
  for (const Rigid3d& pose : report->alternatives) {
    const std::vector<double> second = ResidualsUnder(problem, pose, in_pixels);
    RivalGroups rivals{.in_pixels = in_pixels,
                       .pairs = count,
                       .groups = {GroupOf(report->cam_from_lidar, first, second, 2.0 * largest),
                                  GroupOf(pose, second, first, 2.0 * largest)}};
    auto& [larger, smaller] = rivals.groups;
    if (larger.members.size() < smaller.members.size()) std::swap(larger, smaller);
    const auto wanted = kRivalShare * static_cast<double>(larger.members.size());
    if (smaller.members.size() >= min_members &&
        static_cast<double>(smaller.members.size()) >= wanted) {
      return rivals;
    }
  }
  return std::nullopt;
}

std::string Describe(const RivalGroups& rivals, std::span<const RepeatedPairs> repeated) {
  constexpr std::size_t kMaxListed = 8;
  const PairGroup& larger = rivals.groups[0];
  const PairGroup& smaller = rivals.groups[1];
  std::string rows;
  for (std::size_t i = 0; i < std::min(smaller.members.size(), kMaxListed); ++i) {
    rows += fmt::format("{}{}", i == 0 ? "" : ", ",
                        PlaceInFile(smaller.members[i], rivals.in_pixels, repeated));
  }
  if (smaller.members.size() > kMaxListed) rows += ", ...";
  const PoseDistance apart = DistanceBetween(larger.cam_from_lidar, smaller.cam_from_lidar);
  return fmt::format(
      "groups: two groups of the {} pairs contradict each other: {} agree {}, {} others (pair {}) "
      "{}, {:.0f} mm and {:.1f} deg from the first. The data does not determine which is right: "
      "did a sensor or a board move in between, or do the points of one group not belong together? "
      "Solve the right group alone",
      rivals.pairs, larger.members.size(), Agreement(larger, rivals.in_pixels),
      smaller.members.size(), rows, Agreement(smaller, rivals.in_pixels),
      apart.translation_m * kMmPerM, apart.rotation_rad * kDegPerRad);
}

}  // namespace sextant
