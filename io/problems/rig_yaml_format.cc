// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/text/escape.h"
#include "io/blocks/board_block.h"
#include "io/blocks/board_view_block.h"
#include "io/blocks/camera_block.h"
#include "io/problems/rig_yaml.h"
#include "io/text/degrees.h"
#include "io/text/yaml_text.h"

namespace sextant {
namespace {

void WriteSensor(YamlText& out, const RigFile& rig, std::size_t index) {
  const RigSensor& sensor = rig.problem.sensors[index];
  out.Line("  - name: {}", YamlQuoted(sensor.name));
  if (sensor.camera) {
    out.Line("    camera:");
    WriteCameraKeys(out, "      ", *sensor.camera);
  } else {
    const LidarErrorModel& errors = sensor.lidar_errors;
    out.Line(
        "    lidar_errors: {{ring_offset_sigma_m: {}, range_offset_sigma_m: {}, "
        "edge_growth_sigma_m: {}, view_shift_sigma_m: {}}}",
        errors.ring_offset_sigma_m, errors.range_offset_sigma_m, errors.edge_growth_sigma_m,
        errors.view_shift_sigma_m);
  }
  if (!rig.true_rig_from_sensor.empty()) {
    out.Line("    true_rig_from_sensor: {}", YamlPose(rig.true_rig_from_sensor[index]));
  }
}

// One number where all points have the same.
std::string SigmasText(const std::vector<MeasuredPoint>& points) {
  std::vector<double> sigmas;
  for (const MeasuredPoint& point : points) sigmas.push_back(point.sigma_m);
  const bool is_one = std::ranges::all_of(sigmas, [&](double s) { return s == sigmas[0]; });
  return is_one ? fmt::format("{}", sigmas[0]) : YamlList(sigmas);
}

void WriteFeatures(YamlText& out, const RigObservation& seen) {
  if (!seen.points.empty()) {
    std::vector<double> in_board;
    for (const MeasuredPoint& point : seen.points) {
      in_board.insert(in_board.end(), {point.in_board_m.x(), point.in_board_m.y()});
    }
    out.Line("        in_board_m: {}", YamlList(in_board));
    out.Line("        sigma_m: {}", SigmasText(seen.points));
    out.Line("        points_m:");
    for (const MeasuredPoint& point : seen.points) {
      out.Line("          - {}", YamlList(point.in_sensor_m));
    }
  }
  if (seen.plane) {
    out.Line("        plane: {{normal: {}, distance_m: {}, sigma_m: {}, sigma_deg: {}}}",
             YamlList(seen.plane->normal), seen.plane->distance_m, seen.plane->sigma_m,
             ExactDegrees(seen.plane->sigma_rad));
  }
  if (!seen.lines.empty()) out.Line("        lines:");
  for (const MeasuredLine& line : seen.lines) {
    out.Line("          - {{side: {}, point_m: {}, direction: {}, sigma_m: {}}}", line.side,
             YamlList(line.point), YamlList(line.direction), line.sigma_m);
  }
}

void WriteObservation(YamlText& out, const RigProblem& problem, const RigPlacement& placement,
                      const RigObservation& seen) {
  out.Line("      - sensor: {}", YamlQuoted(problem.sensors[seen.sensor].name));
  out.Line("        board: {}", placement.board);
  if (seen.time_s) out.Line("        time_s: {}", *seen.time_s);
  if (seen.sensor_from_board) {
    out.Line("        sensor_from_board: {}", YamlPose(*seen.sensor_from_board));
  }
  if (!seen.raw.printed.empty()) out.Line("        printed:");
  WriteObservations(out, "        ", "face_m", seen.raw);
  WriteFeatures(out, seen);
}

}  // namespace

std::string FormatRigFile(const RigFile& rig) {
  const RigProblem& problem = rig.problem;
  YamlText out;
  out.Line("sextant_rig: 1");
  out.Line("root: {}", YamlQuoted(problem.sensors[rig.root].name));
  out.Line("sensors:");
  for (std::size_t s = 0; s < problem.sensors.size(); ++s) WriteSensor(out, rig, s);
  out.Line("boards:");
  for (const Board& board : problem.boards) {
    out.Line("  - {{id: {}, top_right_m: {}, right_bottom_m: {}{}}}", board.id, board.top_right_m,
             board.right_bottom_m, YamlOpenings(board));
  }
  out.Line("moments:{}", problem.placements.empty() ? " []" : "");
  const RigPlacement* before = nullptr;
  for (const RigPlacement& placement : problem.placements) {
    if (before == nullptr || before->moment != placement.moment) {
      const std::string name =
          placement.name.empty() ? std::to_string(placement.moment) : placement.name;
      out.Line("  - name: {}", YamlQuoted(name));
      out.Line("    observations:{}", placement.seen.empty() ? " []" : "");
    }
    before = &placement;
    for (const RigObservation& seen : placement.seen) {
      WriteObservation(out, problem, placement, seen);
    }
  }
  return out.Take();
}

}  // namespace sextant
