// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <span>

#include "base/text/escape.h"
#include "io/blocks/board_block.h"
#include "io/blocks/board_view_block.h"
#include "io/blocks/camera_block.h"
#include "io/problems/problem_yaml.h"
#include "io/text/yaml_text.h"

namespace sextant {
namespace {

std::string Id(const PairId& id) {
  return fmt::format("{{view: {}, board: {}, corner: {}}}", id.view, id.board, id.corner);
}

void WritePair(YamlText& out, const Pair3d3d& pair) {
  out.Line("  - id: {}", Id(pair.id));
  out.Line("    point_in_cam: {}", YamlList(pair.point_in_cam));
  out.Line("    point_in_lidar: {}", YamlList(pair.point_in_lidar));
  if (pair.sigma_m != 0.0) out.Line("    sigma_m: {}", pair.sigma_m);
  if (pair.covariance_in_cam) {
    const Eigen::Matrix3d& m = *pair.covariance_in_cam;
    out.Line("    covariance_in_cam_m2: {}", YamlList(std::span<const double>(m.data(), 9)));
  }
}

void WritePair(YamlText& out, const Pair2d3d& pair) {
  out.Line("  - id: {}", Id(pair.id));
  out.Line("    pixel: [{}, {}]", pair.pixel.x(), pair.pixel.y());
  out.Line("    point_in_lidar: {}", YamlList(pair.point_in_lidar));
  if (pair.sigma_px != 0.0) out.Line("    sigma_px: {}", pair.sigma_px);
}

void WritePoints(YamlText& out, const char* key, std::span<const Eigen::Vector3d> points) {
  out.Line("  {}:{}", key, points.empty() ? " []" : "");
  for (const Eigen::Vector3d& point : points) out.Line("    - {}", YamlList(point));
}

}  // namespace

std::string FormatProblemYaml(const ProblemFile& file) {
  const CalibrationProblem& problem = file.problem;
  YamlText out;
  out.Line("sextant_problem: 1");
  if (!file.comment.empty()) out.Line("comment: {}", YamlQuoted(file.comment));
  if (problem.camera) WriteCameraBlock(out, *problem.camera);
  if (!problem.boards.empty()) out.Line("boards:");
  for (const Board& board : problem.boards) {
    out.Line("  - {{id: {}, top_right_m: {}, right_bottom_m: {}{}}}", board.id, board.top_right_m,
             board.right_bottom_m, YamlOpenings(board));
  }
  if (problem.initial_cam_from_lidar) {
    out.Line("initial_cam_from_lidar:");
    WriteYamlPose(out, "  ", *problem.initial_cam_from_lidar);
  }
  if (!problem.pairs_3d3d.empty()) out.Line("pairs_3d3d:");
  for (const Pair3d3d& pair : problem.pairs_3d3d) WritePair(out, pair);
  if (!problem.pairs_2d3d.empty()) out.Line("pairs_2d3d:");
  for (const Pair2d3d& pair : problem.pairs_2d3d) WritePair(out, pair);
  if (!problem.board_views.empty()) {
    WriteLidarErrors(out, problem.lidar_errors);
    out.Line("board_views:");
  }
  for (const BoardView& view : problem.board_views) WriteBoardView(out, view);
  const PointSets implied = WithholdPairing(problem.pairs_3d3d);
  if (problem.point_sets.in_cam != implied.in_cam ||
      problem.point_sets.in_lidar != implied.in_lidar) {
    out.Line("point_sets:");
    WritePoints(out, "in_cam", problem.point_sets.in_cam);
    WritePoints(out, "in_lidar", problem.point_sets.in_lidar);
  }
  if (file.true_cam_from_lidar) {
    out.Line("truth:");
    out.Line("  cam_from_lidar:");
    WriteYamlPose(out, "    ", *file.true_cam_from_lidar);
  }
  return out.Take();
}

}  // namespace sextant
