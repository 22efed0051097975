// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/measured_boards.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/median.h"

namespace sextant {
namespace {

constexpr double kNoticeable = 0.015;  // Share of the edge.
constexpr double kEdgeSigmas = 3.0;
constexpr double kEdgeNoise_m = 0.002;  // Noise of one view, besides the scatter between views.

// Standard deviation of the median of normally distributed values (1.2533 / sqrt(n)), whose scatter
// is taken from their median absolute deviation.
double SigmaOfMedian(const std::vector<double>& values, double median) {
  std::vector<double> deviations;
  for (const double value : values) deviations.push_back(std::abs(value - median));
  const double scatter = std::max(1.4826 * Median(deviations), kEdgeNoise_m);
  return 1.2533 * scatter / std::sqrt(static_cast<double>(values.size()));
}

using SidesOfBoards = std::map<int, std::array<std::vector<double>, 2>>;

SidesOfBoards SidesSeen(std::span<const SessionView> views, const Assembly& assembly) {
  SidesOfBoards sides;
  for (const MatchedBoard& kept : assembly.matching.kept) {
    const LidarSighting& patch = views[static_cast<std::size_t>(kept.view)]
                                     .seen->in_scan[static_cast<std::size_t>(kept.patch)];
    if (patch.measured_sides_m.empty()) continue;
    const BoardPlacement& best = patch.placements.front();
    const BoardPlacement& taken = patch.placements[static_cast<std::size_t>(kept.placement)];
    const auto turned = static_cast<std::size_t>(std::abs(best.turn - taken.turn) % 2);
    for (std::size_t i = 0; i < 2; ++i) {
      const double mean = 0.5 * (patch.measured_sides_m[i] + patch.measured_sides_m[i + 2]);
      sides[taken.board][(i + turned) % 2].push_back(mean);
    }
  }
  return sides;
}

bool IsSignificant(const MeasuredEdge& edge) {
  const double limit = std::max(kNoticeable * edge.stated_m, kEdgeSigmas * edge.sigma_m);
  return std::abs(edge.measured_m - edge.stated_m) > limit;
}

}  // namespace

std::vector<MeasuredEdge> MeasureEdges(std::span<const SessionView> views,
                                       const Assembly& assembly) {
  std::vector<MeasuredEdge> edges;
  for (auto& [board, sides] : SidesSeen(views, assembly)) {
    const auto stated = assembly.problem.boards[static_cast<std::size_t>(board)].EdgeLengths();
    for (std::size_t i = 0; i < 2; ++i) {
      std::vector<double> values = sides[i];
      const double median = Median(values);
      edges.push_back({.board = board,
                       .edge = static_cast<int>(i),
                       .stated_m = stated[i],
                       .measured_m = median,
                       .sigma_m = SigmaOfMedian(values, median)});
    }
  }
  return edges;
}

bool ContradictsFile(const MeasuredEdge& edge) {
  return IsSignificant(edge) && !(edge.Excess() > 0.0 && edge.Excess() < kMaxBeamSpread);
}

std::vector<std::string> DescribeEdges(std::span<const MeasuredEdge> edges,
                                       const Assembly& assembly) {
  std::vector<std::string> lines;
  double widest = 0.0;
  for (const MeasuredEdge& edge : edges) {
    if (ContradictsFile(edge)) {
      lines.push_back(fmt::format(
          "board file: board {} measures {:.3f} m from {} in the scans, the file states {:.3f} m: "
          "measure the board",
          assembly.problem.boards[static_cast<std::size_t>(edge.board)].id, edge.measured_m,
          edge.edge == 0 ? "top to right" : "right to bottom", edge.stated_m));
    } else if (IsSignificant(edge)) {
      widest = std::max(widest, edge.Excess());
    }
  }
  if (lines.empty() && widest > 0.0) {
    lines.push_back(
        fmt::format("outlines look {:.1f} percent wide to the LiDAR: its beam, not your board",
                    100.0 * widest));
  }
  return lines;
}

std::optional<PrintFit> MeasurePrints(std::span<const SessionView> views,
                                      const Assembly& assembly) {
  constexpr int kPoseUnknowns = 6;
  std::vector<double> rms_px;
  std::vector<double> over_noise;
  for (const MatchedBoard& kept : assembly.matching.kept) {
    const BoardPose& pose = views[static_cast<std::size_t>(kept.view)]
                                .seen->in_image[static_cast<std::size_t>(kept.sighting)]
                                .pose;
    if (pose.residuals <= kPoseUnknowns) continue;
    rms_px.push_back(pose.rms_px);
    over_noise.push_back(std::sqrt(pose.chi_square / (pose.residuals - kPoseUnknowns)));
  }
  if (rms_px.empty()) return std::nullopt;
  return PrintFit{.rms_px = UpperMedian(rms_px), .over_noise = UpperMedian(over_noise)};
}

std::optional<double> NormalsOff(const CalibrationProblem& problem, const Rigid3d& cam_from_lidar) {
  std::vector<double> angles;
  for (const BoardView& view : problem.board_views) {
    const Eigen::Vector3d by_image = view.cam_from_board.rotation * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d by_scan =
        cam_from_lidar.rotation * (view.lidar_from_board.rotation * Eigen::Vector3d::UnitZ());
    angles.push_back(std::acos(std::clamp(by_image.dot(by_scan), -1.0, 1.0)));
  }
  if (angles.empty()) return std::nullopt;
  return Median(angles);
}

}  // namespace sextant
