// SPDX-License-Identifier: Apache-2.0
#include "io/blocks/board_block.h"

#include <fmt/core.h>

#include <map>
#include <utility>

#include "base/text/escape.h"
#include "base/units.h"
#include "geometry/board_check.h"
#include "io/blocks/grid_targets.h"
#include "io/text/degrees.h"
#include "io/text/max_id.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

constexpr int kMaxTags = 1000;
constexpr int kMaxAlong = 1000;  // Tags or squares along a side of a grid.

BoardTag ReadTag(YamlFields& in, const YamlNode& node) {
  static const std::vector<std::string> kKeys = {"family", "id", "edge_m", "center_in_board_m",
                                                 "rotation_deg"};
  BoardTag tag;
  if (!in.IsMap(node, "tag", kKeys)) return tag;
  tag.family = in.TextAt(node, "family");
  tag.id = in.IntegerAt(node, "id", 0, kMaxId);
  tag.edge_m = in.RealAt(node, "edge_m");
  tag.center_in_board_m = in.Point2At(node, "center_in_board_m", Eigen::Vector2d::Zero());
  tag.rotation_rad = kRadPerDeg * in.RealAt(node, "rotation_deg", 0.0);
  return tag;
}

bool ReadFlag(YamlFields& in, const YamlNode& node, const char* key) {
  const YamlNode* flag = node.Find(key);
  if (flag == nullptr) return false;
  const std::string text = in.Text(*flag, key);
  if (in.ok() && text != "true" && text != "false")
    in.Fail(flag->line, key, "expected true or false");
  return text == "true";
}

BoardChecker ReadChecker(YamlFields& in, const YamlNode& node) {
  static const std::vector<std::string> kKeys = {"inner_columns",     "inner_rows",   "square_m",
                                                 "center_in_board_m", "starts_white", "holds_tags"};
  BoardChecker checker;
  if (!in.IsMap(node, "checker", kKeys)) return checker;
  checker.inner_columns = in.IntegerAt(node, "inner_columns", 0, kMaxId);
  checker.inner_rows = in.IntegerAt(node, "inner_rows", 0, kMaxId);
  checker.square_m = in.RealAt(node, "square_m");
  checker.center_in_board_m = in.Point2At(node, "center_in_board_m", Eigen::Vector2d::Zero());
  checker.starts_white = ReadFlag(in, node, "starts_white");
  checker.holds_tags = ReadFlag(in, node, "holds_tags");
  return checker;
}

void ReadTags(YamlFields& in, const YamlNode& node, Board& board) {
  if (!in.IsSequence(node, "tags")) return;
  if (std::ssize(node.items) > kMaxTags) {
    in.Fail(node.line, "tags", fmt::format("expected at most {} tags", kMaxTags));
    return;
  }
  for (const YamlNode& item : node.items) board.tags.push_back(ReadTag(in, item));
}

// Whether a grid has at most kMaxTags tags; `per_tag`: cells of the grid for each.
bool IsAffordable(YamlFields& in, const YamlNode& node, const char* name, int cells, int per_tag) {
  if (!in.ok()) return false;
  if (cells / per_tag <= kMaxTags) return true;
  in.Fail(node.line, name, fmt::format("expected at most {} tags", kMaxTags));
  return false;
}

void ReadAprilGrid(YamlFields& in, const YamlNode& node, Board& board) {
  static const std::vector<std::string> kKeys = {"columns", "rows",     "tag_m",
                                                 "spacing", "first_id", "center_in_board_m"};
  if (!in.IsMap(node, "aprilgrid", kKeys)) return;
  AprilGrid grid;
  grid.columns = in.IntegerAt(node, "columns", 1, kMaxAlong);
  grid.rows = in.IntegerAt(node, "rows", 1, kMaxAlong);
  grid.tag_m = in.RealAt(node, "tag_m");
  grid.spacing = in.NonNegativeAt(node, "spacing", 0.3);
  grid.first_id = in.IntegerAt(node, "first_id", 0, kMaxId, 0);
  grid.center_in_board_m = in.Point2At(node, "center_in_board_m", Eigen::Vector2d::Zero());
  if (IsAffordable(in, node, "aprilgrid", grid.columns * grid.rows, 1)) AddTo(grid, board);
}

void ReadCharuco(YamlFields& in, const YamlNode& node, Board& board) {
  static const std::vector<std::string> kKeys = {
      "columns", "rows",     "square_m", "marker_m",
      "family",  "first_id", "legacy",   "center_in_board_m"};
  if (!in.IsMap(node, "charuco", kKeys)) return;
  if (board.checker) {
    in.Fail(node.line, "charuco", "expected either a checker or a charuco, got both");
    return;
  }
  CharucoGrid grid;
  grid.columns = in.IntegerAt(node, "columns", 3, kMaxAlong);
  grid.rows = in.IntegerAt(node, "rows", 3, kMaxAlong);
  grid.square_m = in.RealAt(node, "square_m");
  grid.marker_m = in.RealAt(node, "marker_m");
  grid.family = in.TextAt(node, "family");
  grid.first_id = in.IntegerAt(node, "first_id", 0, kMaxId, 0);
  grid.legacy = ReadFlag(in, node, "legacy");
  grid.center_in_board_m = in.Point2At(node, "center_in_board_m", Eigen::Vector2d::Zero());
  if (IsAffordable(in, node, "charuco", grid.columns * grid.rows, 2)) AddTo(grid, board);
}

// The node that states tag `index` of a board: those of grids follow those of the list.
std::pair<const YamlNode*, std::string> TagNode(const YamlNode& board, std::size_t index) {
  const YamlNode* list = board.Find("tags");
  const std::size_t listed = list == nullptr ? 0 : list->items.size();
  if (index < listed) return {&list->items[index], fmt::format("tag {}", index)};
  if (const YamlNode* grid = board.Find("aprilgrid")) return {grid, "aprilgrid"};
  return {board.Find("charuco"), "charuco"};
}

// The node of the part that has the fault, and the name of the part.
std::pair<const YamlNode*, std::string> PartOf(const YamlNode& board, const BoardFault& fault) {
  switch (fault.part) {
    case BoardFault::Part::kHole:
      return {board.Find("hole"), "hole"};
    case BoardFault::Part::kRoundHole:
      return {&board.Find("round_holes")->items[static_cast<std::size_t>(fault.index)],
              fmt::format("round_holes {}", fault.index)};
    case BoardFault::Part::kChecker:
      if (const YamlNode* charuco = board.Find("charuco")) return {charuco, "charuco"};
      return {board.Find("checker"), "checker"};
    case BoardFault::Part::kTag:
      return TagNode(board, static_cast<std::size_t>(fault.index));
    case BoardFault::Part::kBoard:
      break;
  }
  return {&board, "board"};
}

void FailWith(YamlFields& in, const YamlNode& node, const BoardFault& fault) {
  const auto [part, name] = PartOf(node, fault);
  const YamlNode* field = fault.field.empty() ? nullptr : part->Find(fault.field);
  in.Fail(field != nullptr ? field->line : part->line,
          fault.field.empty() ? name : name + ": " + fault.field, fault.message);
}

BoardHole ReadHole(YamlFields& in, const YamlNode& node) {
  static const std::vector<std::string> kKeys = {"width_m", "height_m", "center_in_board_m"};
  BoardHole hole;
  if (!in.IsMap(node, "hole", kKeys)) return hole;
  hole.width_m = in.RealAt(node, "width_m");
  hole.height_m = in.RealAt(node, "height_m");
  hole.center_in_board_m = in.Point2At(node, "center_in_board_m", Eigen::Vector2d::Zero());
  return hole;
}

std::string YamlHole(const BoardHole& hole) {
  return fmt::format("{{width_m: {}, height_m: {}, center_in_board_m: {}}}", hole.width_m,
                     hole.height_m, YamlList(hole.center_in_board_m));
}

std::vector<RoundHole> ReadRoundHoles(YamlFields& in, const YamlNode& list) {
  static const std::vector<std::string> kKeys = {"radius_m", "center_in_board_m"};
  std::vector<RoundHole> holes;
  if (!in.IsSequence(list, "round_holes", kMaxRoundHoles)) return holes;
  for (const YamlNode& node : list.items) {
    if (!in.IsMap(node, "round_holes", kKeys)) return holes;
    RoundHole hole;
    hole.radius_m = in.RealAt(node, "radius_m");
    hole.center_in_board_m = in.Point2At(node, "center_in_board_m", Eigen::Vector2d::Zero());
    holes.push_back(hole);
  }
  return holes;
}

std::string YamlRoundHole(const RoundHole& hole) {
  return fmt::format("{{radius_m: {}, center_in_board_m: {}}}", hole.radius_m,
                     YamlList(hole.center_in_board_m));
}

}  // namespace

void ReadOpenings(YamlFields& in, const YamlNode& node, Board& board) {
  if (const YamlNode* hole = node.Find("hole")) board.hole = ReadHole(in, *hole);
  if (const YamlNode* holes = node.Find("round_holes")) {
    board.round_holes = ReadRoundHoles(in, *holes);
  }
}

std::string YamlOpenings(const Board& board) {
  std::string text;
  if (board.hole) text += ", hole: " + YamlHole(*board.hole);
  std::string holes;
  for (const RoundHole& hole : board.round_holes) {
    holes += (holes.empty() ? "" : ", ") + YamlRoundHole(hole);
  }
  return holes.empty() ? text : text + ", round_holes: [" + holes + "]";
}

Board ReadBoardBlock(YamlFields& in, const YamlNode& node) {
  static const std::vector<std::string> kKeys = {
      "id",          "name", "top_right_m", "right_bottom_m", "thickness_m", "hole",
      "round_holes", "tags", "checker",     "aprilgrid",      "charuco"};
  Board board;
  if (!in.IsMap(node, "board", kKeys)) return board;
  board.id = in.IntegerAt(node, "id", 0, kMaxId);
  if (node.Find("name") != nullptr) board.name = in.TextAt(node, "name");
  board.top_right_m = in.RealAt(node, "top_right_m");
  board.right_bottom_m = in.RealAt(node, "right_bottom_m");
  board.thickness_m = in.RealAt(node, "thickness_m", 0.0);
  ReadOpenings(in, node, board);
  if (const YamlNode* tags = node.Find("tags")) ReadTags(in, *tags, board);
  if (const YamlNode* checker = node.Find("checker")) board.checker = ReadChecker(in, *checker);
  if (const YamlNode* grid = node.Find("aprilgrid")) ReadAprilGrid(in, *grid, board);
  if (const YamlNode* charuco = node.Find("charuco")) ReadCharuco(in, *charuco, board);
  if (!in.ok()) return board;
  if (const std::optional<BoardFault> fault = FindBoardFault(board)) FailWith(in, node, *fault);
  return board;
}

void RequireDistinctBoards(YamlFields& in, const std::vector<const YamlNode*>& nodes,
                           const std::vector<Board>& boards) {
  std::map<int, int> line_of_board;
  std::map<std::pair<std::string, int>, int> board_of_tag;
  for (std::size_t i = 0; i < boards.size() && in.ok(); ++i) {
    const Board& board = boards[i];
    const YamlNode& node = *nodes[i];
    const auto [place, is_new] = line_of_board.emplace(board.id, node.line);
    if (!is_new) {
      in.Fail(node.Find("id")->line, "id",
              fmt::format("the board on line {} already has the id {}", place->second, board.id));
    }
    for (std::size_t k = 0; k < board.tags.size(); ++k) {
      const BoardTag& tag = board.tags[k];
      const auto [holder, first] = board_of_tag.emplace(std::pair(tag.family, tag.id), board.id);
      if (first) continue;
      const auto [stated, name] = TagNode(node, k);
      in.Fail(stated->line, name + ": id",
              fmt::format("the id {} of {} is already on board {}; a detector could not "
                          "distinguish the two tags",
                          tag.id, Quoted(tag.family), holder->second));
    }
  }
}

void WriteBoardBlock(YamlText& out, const std::string& indent, const Board& board) {
  out.Line("{}- id: {}", indent, board.id);
  if (!board.name.empty()) out.Line("{}  name: {}", indent, YamlQuoted(board.name));
  out.Line("{}  top_right_m: {}", indent, board.top_right_m);
  out.Line("{}  right_bottom_m: {}", indent, board.right_bottom_m);
  if (board.thickness_m != 0.0) out.Line("{}  thickness_m: {}", indent, board.thickness_m);
  if (board.hole) out.Line("{}  hole: {}", indent, YamlHole(*board.hole));
  if (!board.round_holes.empty()) out.Line("{}  round_holes:", indent);
  for (const RoundHole& hole : board.round_holes) {
    out.Line("{}    - {}", indent, YamlRoundHole(hole));
  }
  if (!board.tags.empty()) out.Line("{}  tags:", indent);
  for (const BoardTag& tag : board.tags) {
    out.Line("{}    - {{family: {}, id: {}, edge_m: {}, center_in_board_m: {}, rotation_deg: {}}}",
             indent, YamlQuoted(tag.family), tag.id, tag.edge_m, YamlList(tag.center_in_board_m),
             ExactDegrees(tag.rotation_rad));
  }
  if (board.checker) {
    out.Line(
        "{}  checker: {{inner_columns: {}, inner_rows: {}, square_m: {}, "
        "center_in_board_m: {}{}{}}}",
        indent, board.checker->inner_columns, board.checker->inner_rows, board.checker->square_m,
        YamlList(board.checker->center_in_board_m),
        board.checker->starts_white ? ", starts_white: true" : "",
        board.checker->holds_tags ? ", holds_tags: true" : "");
  }
}

}  // namespace sextant
