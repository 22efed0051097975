// SPDX-License-Identifier: Apache-2.0
#include "io/blocks/board_block.h"

#include <fmt/core.h>

#include <map>
#include <utility>

#include "base/text/escape.h"
#include "base/units.h"
#include "geometry/board_check.h"
#include "io/text/degrees.h"
#include "io/text/max_id.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxTags = 1000;

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

BoardChecker ReadChecker(YamlFields& in, const YamlNode& node) {
  static const std::vector<std::string> kKeys = {"inner_columns", "inner_rows", "square_m",
                                                 "center_in_board_m"};
  BoardChecker checker;
  if (!in.IsMap(node, "checker", kKeys)) return checker;
  checker.inner_columns = in.IntegerAt(node, "inner_columns", 0, kMaxId);
  checker.inner_rows = in.IntegerAt(node, "inner_rows", 0, kMaxId);
  checker.square_m = in.RealAt(node, "square_m");
  checker.center_in_board_m = in.Point2At(node, "center_in_board_m", Eigen::Vector2d::Zero());
  return checker;
}

void ReadTags(YamlFields& in, const YamlNode& node, Board& board) {
  if (!in.IsSequence(node, "tags")) return;
  if (node.items.size() > kMaxTags) {
    in.Fail(node.line, "tags", fmt::format("expected at most {} tags", kMaxTags));
    return;
  }
  for (const YamlNode& item : node.items) board.tags.push_back(ReadTag(in, item));
}

// The node of the part that has the fault, and the name of the part.
std::pair<const YamlNode*, std::string> PartOf(const YamlNode& board, const BoardFault& fault) {
  switch (fault.part) {
    case BoardFault::Part::kHole:
      return {board.Find("hole"), "hole"};
    case BoardFault::Part::kChecker:
      return {board.Find("checker"), "checker"};
    case BoardFault::Part::kTag:
      return {&board.Find("tags")->items[static_cast<std::size_t>(fault.tag)],
              fmt::format("tag {}", fault.tag)};
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

}  // namespace

BoardHole ReadHoleBlock(YamlFields& in, const YamlNode& node) {
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

Board ReadBoardBlock(YamlFields& in, const YamlNode& node) {
  static const std::vector<std::string> kKeys = {
      "id", "name", "top_right_m", "right_bottom_m", "thickness_m", "hole", "tags", "checker"};
  Board board;
  if (!in.IsMap(node, "board", kKeys)) return board;
  board.id = in.IntegerAt(node, "id", 0, kMaxId);
  if (node.Find("name") != nullptr) board.name = in.TextAt(node, "name");
  board.top_right_m = in.RealAt(node, "top_right_m");
  board.right_bottom_m = in.RealAt(node, "right_bottom_m");
  board.thickness_m = in.RealAt(node, "thickness_m", 0.0);
  if (const YamlNode* hole = node.Find("hole")) board.hole = ReadHoleBlock(in, *hole);
  if (const YamlNode* tags = node.Find("tags")) ReadTags(in, *tags, board);
  if (const YamlNode* checker = node.Find("checker")) board.checker = ReadChecker(in, *checker);
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
      in.Fail(
          node.Find("tags")->items[k].line, fmt::format("tag {}: id", k),
          fmt::format("the id {} of {} is already on board {}; a detector could not distinguish "
                      "the two tags",
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
  if (!board.tags.empty()) out.Line("{}  tags:", indent);
  for (const BoardTag& tag : board.tags) {
    out.Line("{}    - {{family: {}, id: {}, edge_m: {}, center_in_board_m: {}, rotation_deg: {}}}",
             indent, YamlQuoted(tag.family), tag.id, tag.edge_m, YamlList(tag.center_in_board_m),
             ExactDegrees(tag.rotation_rad));
  }
  if (board.checker) {
    out.Line(
        "{}  checker: {{inner_columns: {}, inner_rows: {}, square_m: {}, "
        "center_in_board_m: {}}}",
        indent, board.checker->inner_columns, board.checker->inner_rows, board.checker->square_m,
        YamlList(board.checker->center_in_board_m));
  }
}

}  // namespace sextant
