// SPDX-License-Identifier: Apache-2.0
#include "io/boards/polygon_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "geometry/board.h"
#include "io/blocks/camera_block.h"
#include "io/blocks/pose_block.h"
#include "io/text/max_id.h"
#include "io/text/text_file.h"
#include "io/text/yaml_fields.h"
#include "io/text/yaml_text.h"

namespace sextant {
namespace {

using Keys = std::vector<std::string>;

constexpr int kMaxCorner = 7;  // Corners 4 to 7 are those of a hollow board's opening.
constexpr std::size_t kEdges = 4;

Eigen::Vector2d ReadPixel(YamlFields& in, const YamlNode& node, std::string_view what) {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  in.Reals(node, what, {pixel.data(), 2});
  return pixel;
}

// Whether it is a list of at most `max_size` items.
bool IsList(YamlFields& in, const YamlNode& node, std::string_view what, std::size_t max_size) {
  if (!in.IsSequence(node, what)) return false;
  if (node.items.size() <= max_size) return true;
  in.Fail(node.line, what, fmt::format("expected at most {}, got {}", max_size, node.items.size()));
  return false;
}

Quadrilateral ReadQuadrilateral(YamlFields& in, const YamlNode& node) {
  Quadrilateral corners{};
  if (!in.IsSequence(node, "edges")) return corners;
  if (node.items.size() != corners.size()) {
    in.Fail(
        node.line, "edges",
        fmt::format("expected four corners [u, v] of a quadrilateral, got {}", node.items.size()));
    return corners;
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = ReadPixel(in, node.items[i], "edges");
  }
  if (in.ok() && CrossesItself(corners)) {
    in.Fail(node.line, "edges",
            "the quadrilateral crosses itself: list its corners in order around it");
  }
  return corners;
}

void ReadPolygonBoards(YamlFields& in, const YamlNode& list, std::vector<MarkedBoard>& boards) {
  static const Keys kKeys = {"id", "edges"};
  if (!in.IsSequence(list, "boards", kMaxBoards)) return;
  for (const YamlNode& node : list.items) {
    if (!in.IsMap(node, "boards", kKeys)) return;
    MarkedBoard board;
    board.id = in.IntegerAt(node, "id", 0, kMaxId);
    const YamlNode& edges = in.Require(node, "edges");
    if (!in.ok() || !IsList(in, edges, "edges", kEdges)) return;
    for (const YamlNode& edge : edges.items) board.edges.push_back(ReadQuadrilateral(in, edge));
    if (std::ranges::count(boards, board.id, &MarkedBoard::id) > 0) {
      in.Fail(node.line, "id", fmt::format("board {} appears twice", board.id));
    }
    boards.push_back(std::move(board));
  }
}

void ReadCorners(YamlFields& in, const YamlNode& list, std::vector<ClickedCorner>& corners) {
  static const Keys kKeys = {"board", "corner", "pixel"};
  if (!in.IsSequence(list, "corners", (kMaxCorner + 1) * kMaxBoards)) return;
  for (const YamlNode& node : list.items) {
    if (!in.IsMap(node, "corners", kKeys)) return;
    ClickedCorner corner;
    corner.board = in.IntegerAt(node, "board", 0, kMaxId);
    corner.corner = in.IntegerAt(node, "corner", 0, kMaxCorner);
    corner.pixel = ReadPixel(in, in.Require(node, "pixel"), "pixel");
    const auto same = [&corner](const ClickedCorner& other) {
      return other.board == corner.board && other.corner == corner.corner;
    };
    if (in.ok() && std::ranges::any_of(corners, same)) {
      in.Fail(node.line, "corner",
              fmt::format("corner {} of board {} appears twice", corner.corner, corner.board));
    }
    corners.push_back(corner);
  }
}

void ReadPolygonHeader(YamlFields& in, const YamlNode& root) {
  static const Keys kKeys = {"sextant_polygons", "camera",  "cam_from_lidar",
                             "boards",           "corners", "unfinished"};
  if (root.kind == YamlNode::Kind::kMap && root.Find("sextant_polygons") == nullptr) {
    in.Fail(root.line, {},
            "expected a polygon file of sextant mark, with the key sextant_polygons: 1; is this "
            "another kind of YAML?");
  }
  if (in.IsMap(root, "sextant_polygons", kKeys)) in.IntegerAt(root, "sextant_polygons", 1, 1);
}

std::string PixelList(const Eigen::Vector2d& pixel) {
  return fmt::format("[{}, {}]", pixel.x(), pixel.y());
}

}  // namespace

Expected<ScanMarks> ReadPolygons(const std::filesystem::path& path) {
  return ReadWith(path, ParsePolygons);
}

Expected<ScanMarks> ParsePolygons(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  YamlFields in(file);
  ReadPolygonHeader(in, root);
  if (!in.ok()) return in.TakeError();
  ScanMarks marks;
  marks.camera = ReadCameraBlock(in, in.Require(root, "camera"));
  marks.cam_from_lidar = ReadPoseBlock(in, in.Require(root, "cam_from_lidar"), "cam_from_lidar");
  if (const YamlNode* boards = root.Find("boards")) ReadPolygonBoards(in, *boards, marks.boards);
  if (const YamlNode* corners = root.Find("corners")) ReadCorners(in, *corners, marks.corners);
  const YamlNode* unfinished = root.Find("unfinished");
  if (unfinished != nullptr && IsList(in, *unfinished, "unfinished", kEdges - 1)) {
    for (const YamlNode& node : unfinished->items) {
      marks.unfinished.push_back(ReadPixel(in, node, "unfinished"));
    }
  }
  if (!in.ok()) return in.TakeError();
  return marks;
}

std::string FormatPolygons(const ScanMarks& marks) {
  YamlText out;
  out.Line("sextant_polygons: 1");
  WriteCameraBlock(out, marks.camera);
  out.Line("cam_from_lidar:");
  WriteYamlPose(out, "  ", marks.cam_from_lidar);
  out.Line("boards:{}", marks.boards.empty() ? " []" : "");
  for (const MarkedBoard& board : marks.boards) {
    out.Line("  - id: {}", board.id);
    out.Line("    edges:{}", board.edges.empty() ? " []" : "");
    for (const Quadrilateral& edge : board.edges) {
      out.Line("      - [{}, {}, {}, {}]", PixelList(edge[0]), PixelList(edge[1]),
               PixelList(edge[2]), PixelList(edge[3]));
    }
  }
  out.Line("corners:{}", marks.corners.empty() ? " []" : "");
  for (const ClickedCorner& corner : marks.corners) {
    out.Line("  - {{board: {}, corner: {}, pixel: {}}}", corner.board, corner.corner,
             PixelList(corner.pixel));
  }
  if (!marks.unfinished.empty()) out.Line("unfinished:");
  for (const Eigen::Vector2d& pixel : marks.unfinished) out.Line("  - {}", PixelList(pixel));
  return out.Take();
}

}  // namespace sextant
