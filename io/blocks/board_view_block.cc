// SPDX-License-Identifier: Apache-2.0
#include "io/blocks/board_view_block.h"

#include <fmt/core.h>

#include <cmath>

#include "io/blocks/pose_block.h"
#include "io/text/max_id.h"
#include "solvers/core/board_view_check.h"

namespace sextant {
namespace {

using Keys = std::vector<std::string>;

constexpr std::size_t kMaxFaceReturns = 10'000'000;
constexpr std::size_t kMaxPrinted = 1000;  ///< Points of one tag or checkerboard.

// x0, y0, x1, y1, ...
std::vector<Eigen::Vector2d> ReadPoints2(YamlFields& in, const YamlNode& map,
                                         std::string_view key) {
  const YamlNode& node = in.Require(map, key);
  const std::vector<double> numbers = in.RealList(node, key, 2 * kMaxPrinted);
  std::vector<Eigen::Vector2d> points;
  if (numbers.size() % 2 != 0) {
    in.Fail(node.line, key,
            fmt::format("expected two numbers per point, got {} numbers", numbers.size()));
  }
  for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) {
    points.emplace_back(numbers[i], numbers[i + 1]);
  }
  return points;
}

BoardPoints ReadPrinted(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"in_board_m", "pixels", "covariance_px2"};
  BoardPoints printed;
  if (!in.IsMap(node, "printed", kKeys)) return printed;
  printed.in_board_m = ReadPoints2(in, node, "in_board_m");
  printed.pixels = ReadPoints2(in, node, "pixels");
  const YamlNode& covariance = in.Require(node, "covariance_px2");
  if (!in.ok()) return printed;
  const auto size = 2 * std::ssize(printed.pixels);
  printed.covariance_px2.resize(size, size);
  in.Reals(
      covariance, "covariance_px2",
      {printed.covariance_px2.data(), static_cast<std::size_t>(printed.covariance_px2.size())});
  return printed;
}

EdgeRay ReadEdge(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"direction", "side", "sigma_m"};
  EdgeRay ray;
  if (!in.IsMap(node, "edges", kKeys)) return ray;
  ray.direction = in.PointAt(node, "direction");
  ray.side = in.IntegerAt(node, "side", 0, kFirstRim + kMaxRoundHoles - 1);
  ray.sigma_m = in.RealAt(node, "sigma_m");
  return ray;
}

BoardView ReadView(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {
      "view",    "board",         "name",          "cam_from_board", "lidar_from_board",
      "printed", "range_sigma_m", "face_in_lidar", "face_rings",     "edges"};
  BoardView view;
  if (!in.IsMap(node, "board_views", kKeys)) return view;
  view.view = in.IntegerAt(node, "view", 0, kMaxId);
  view.board = in.IntegerAt(node, "board", 0, kMaxId);
  if (const YamlNode* name = node.Find("name")) view.name = in.Text(*name, "name");
  view.cam_from_board = ReadPoseBlock(in, in.Require(node, "cam_from_board"), "cam_from_board");
  view.lidar_from_board =
      ReadPoseBlock(in, in.Require(node, "lidar_from_board"), "lidar_from_board");
  in.Require(node, "printed");
  ReadObservations(in, node, "face_in_lidar", view);
  return view;
}

}  // namespace

void ReadObservations(YamlFields& in, const YamlNode& node, const std::string& face_key,
                      BoardView& view) {
  const YamlNode* printed = node.Find("printed");
  if (printed != nullptr && in.IsSequence(*printed, "printed")) {
    for (const YamlNode& item : printed->items) view.printed.push_back(ReadPrinted(in, item));
  }
  const YamlNode* face = node.Find(face_key);
  if (face != nullptr && in.IsSequence(*face, face_key)) {
    view.range_sigma_m = in.RealAt(node, "range_sigma_m");
    for (const YamlNode& item : face->items) {
      view.face_in_lidar.push_back(in.Point(item, face_key));
    }
  }
  if (const YamlNode* rings = node.Find("face_rings")) {
    for (const double ring : in.RealList(*rings, "face_rings", kMaxFaceReturns)) {
      if (!(ring >= 0.0 && ring <= kMaxId) || ring != std::floor(ring)) {
        in.Fail(rings->line, "face_rings",
                fmt::format("expected whole numbers from 0 to {}, got {}", kMaxId, ring));
        break;
      }
      view.face_rings.push_back(static_cast<int>(ring));
    }
  }
  const YamlNode* edges = node.Find("edges");
  if (edges != nullptr && in.IsSequence(*edges, "edges")) {
    for (const YamlNode& item : edges->items) view.edges.push_back(ReadEdge(in, item));
  }
}

void WriteObservations(YamlText& out, const std::string& indent, const std::string& face_key,
                       const BoardView& view) {
  for (const BoardPoints& printed : view.printed) {
    const auto numbers = [](const std::vector<Eigen::Vector2d>& points) {
      std::vector<double> flat;
      for (const Eigen::Vector2d& point : points) flat.insert(flat.end(), {point.x(), point.y()});
      return YamlList(flat);
    };
    out.Line("{}  - in_board_m: {}", indent, numbers(printed.in_board_m));
    out.Line("{}    pixels: {}", indent, numbers(printed.pixels));
    out.Line(
        "{}    covariance_px2: {}", indent,
        YamlList(std::span<const double>(printed.covariance_px2.data(),
                                         static_cast<std::size_t>(printed.covariance_px2.size()))));
  }
  if (!view.face_in_lidar.empty()) {
    out.Line("{}range_sigma_m: {}", indent, view.range_sigma_m);
    out.Line("{}{}:", indent, face_key);
    for (const Eigen::Vector3d& point : view.face_in_lidar) {
      out.Line("{}  - {}", indent, YamlList(point));
    }
    if (!view.face_rings.empty()) {
      const std::vector<double> rings(view.face_rings.begin(), view.face_rings.end());
      out.Line("{}face_rings: {}", indent, YamlList(rings));
    }
  }
  if (!view.edges.empty()) out.Line("{}edges:", indent);
  for (const EdgeRay& ray : view.edges) {
    out.Line("{}  - {{direction: {}, side: {}, sigma_m: {}}}", indent, YamlList(ray.direction),
             ray.side, ray.sigma_m);
  }
}

std::vector<BoardView> ReadBoardViews(YamlFields& in, const YamlNode& list,
                                      std::span<const Board> boards) {
  std::vector<BoardView> views;
  if (!in.IsSequence(list, "board_views")) return views;
  for (const YamlNode& node : list.items) {
    views.push_back(ReadView(in, node));
    if (!in.ok()) return views;
    const Expected<void> ok = CheckBoardView(views.back(), boards);
    if (!ok) in.Fail(node.line, "board_views", ok.error().message);
  }
  if (!in.ok()) return views;
  const Expected<void> ok = CheckBoardViews(views, boards);
  if (!ok) in.Fail(list.line, "board_views", ok.error().message);
  return views;
}

LidarErrorModel ReadLidarErrors(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"ring_offset_sigma_m", "range_offset_sigma_m", "edge_growth_sigma_m",
                             "view_shift_sigma_m"};
  LidarErrorModel errors;
  if (!in.IsMap(node, "lidar_errors", kKeys)) return errors;
  const auto read = [&](const char* key, double& sigma) {
    sigma = in.RealAt(node, key);
    if (!(sigma >= 0.0)) in.Fail(node.line, key, "expected a sigma of 0 or more");
  };
  read("ring_offset_sigma_m", errors.ring_offset_sigma_m);
  read("range_offset_sigma_m", errors.range_offset_sigma_m);
  read("edge_growth_sigma_m", errors.edge_growth_sigma_m);
  read("view_shift_sigma_m", errors.view_shift_sigma_m);
  return errors;
}

void WriteLidarErrors(YamlText& out, const LidarErrorModel& errors) {
  out.Line("lidar_errors:");
  out.Line("  ring_offset_sigma_m: {}", errors.ring_offset_sigma_m);
  out.Line("  range_offset_sigma_m: {}", errors.range_offset_sigma_m);
  out.Line("  edge_growth_sigma_m: {}", errors.edge_growth_sigma_m);
  out.Line("  view_shift_sigma_m: {}", errors.view_shift_sigma_m);
}

void WriteBoardView(YamlText& out, const BoardView& view) {
  out.Line("  - view: {}", view.view);
  out.Line("    board: {}", view.board);
  if (!view.name.empty()) out.Line("    name: {}", YamlQuoted(view.name));
  out.Line("    cam_from_board: {}", YamlPose(view.cam_from_board));
  out.Line("    lidar_from_board: {}", YamlPose(view.lidar_from_board));
  out.Line("    printed:{}", view.printed.empty() ? " []" : "");
  WriteObservations(out, "    ", "face_in_lidar", view);
}

}  // namespace sextant
