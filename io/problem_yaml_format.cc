// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <yaml-cpp/emitter.h>
#include <yaml-cpp/emittermanip.h>

#include <iterator>
#include <span>

#include "io/camera_block.h"
#include "io/problem_yaml.h"

namespace sextant {
namespace {

// Numbers in the fewest digits that read back to the same bits, at most 17.
class Writer {
 public:
  template <class... Values>
  void Line(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    text_ += '\n';
  }
  std::string Take() { return std::move(text_); }

 private:
  std::string text_;
};

std::string List(std::span<const double> values) {
  return fmt::format("[{}]", fmt::join(values, ", "));
}

std::string List(const Eigen::Vector3d& v) { return List(std::span<const double>(v.data(), 3)); }

std::string QuotedText(const std::string& text) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << text;
  return emitter.c_str();
}

void WriteCamera(Writer& out, const Camera& camera) {
  out.Line("camera:");
  out.Line("  model: {}", CameraModelName(camera.model));
  out.Line("  width_px: {}", camera.width_px);
  out.Line("  height_px: {}", camera.height_px);
  out.Line("  fx_px: {}", camera.fx_px);
  out.Line("  fy_px: {}", camera.fy_px);
  out.Line("  cx_px: {}", camera.cx_px);
  out.Line("  cy_px: {}", camera.cy_px);
  out.Line("  distortion: {}", List(camera.distortion));
}

void WritePose(Writer& out, const char* indent, const Rigid3d& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  out.Line("{}translation_m: {}", indent, List(pose.translation));
  out.Line("{}quaternion_wxyz: [{}, {}, {}, {}]", indent, q.w(), q.x(), q.y(), q.z());
}

std::string Id(const PairId& id) {
  return fmt::format("{{view: {}, board: {}, corner: {}}}", id.view, id.board, id.corner);
}

void WritePair(Writer& out, const Pair3d3d& pair) {
  out.Line("  - id: {}", Id(pair.id));
  out.Line("    point_in_cam: {}", List(pair.point_in_cam));
  out.Line("    point_in_lidar: {}", List(pair.point_in_lidar));
  if (pair.sigma_m != 0.0) out.Line("    sigma_m: {}", pair.sigma_m);
  if (pair.covariance_in_cam) {
    const Eigen::Matrix3d& m = *pair.covariance_in_cam;
    out.Line("    covariance_in_cam_m2: {}", List(std::span<const double>(m.data(), 9)));
  }
}

void WritePair(Writer& out, const Pair2d3d& pair) {
  out.Line("  - id: {}", Id(pair.id));
  out.Line("    pixel: [{}, {}]", pair.pixel.x(), pair.pixel.y());
  out.Line("    point_in_lidar: {}", List(pair.point_in_lidar));
  if (pair.sigma_px != 0.0) out.Line("    sigma_px: {}", pair.sigma_px);
}

void WritePoints(Writer& out, const char* key, std::span<const Eigen::Vector3d> points) {
  out.Line("  {}:{}", key, points.empty() ? " []" : "");
  for (const Eigen::Vector3d& point : points) out.Line("    - {}", List(point));
}

}  // namespace

std::string FormatProblemYaml(const ProblemFile& file) {
  const CalibrationProblem& problem = file.problem;
  Writer out;
  out.Line("sextant_problem: 1");
  if (!file.comment.empty()) out.Line("comment: {}", QuotedText(file.comment));
  if (problem.camera) WriteCamera(out, *problem.camera);
  if (!problem.boards.empty()) out.Line("boards:");
  for (const Board& board : problem.boards) {
    out.Line("  - {{id: {}, top_right_m: {}, right_bottom_m: {}}}", board.id, board.top_right_m,
             board.right_bottom_m);
  }
  if (problem.initial_cam_from_lidar) {
    out.Line("initial_cam_from_lidar:");
    WritePose(out, "  ", *problem.initial_cam_from_lidar);
  }
  if (!problem.pairs_3d3d.empty()) out.Line("pairs_3d3d:");
  for (const Pair3d3d& pair : problem.pairs_3d3d) WritePair(out, pair);
  if (!problem.pairs_2d3d.empty()) out.Line("pairs_2d3d:");
  for (const Pair2d3d& pair : problem.pairs_2d3d) WritePair(out, pair);
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
    WritePose(out, "    ", *file.true_cam_from_lidar);
  }
  return out.Take();
}

}  // namespace sextant
