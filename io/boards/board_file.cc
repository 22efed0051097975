// SPDX-License-Identifier: Apache-2.0
#include "io/boards/board_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <initializer_list>
#include <numbers>

#include "geometry/board_check.h"
#include "io/blocks/board_block.h"
#include "io/boards/kalibr_target.h"
#include "io/text/line_reader.h"
#include "io/text/max_id.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

// Only marker_coordinates.txt begins with a line that holds a single number.
bool IsMarkerCoordinates(std::string_view text, const std::string& file) {
  LineReader in(file, text);
  return in.Next() && in.field_count() == 1 && ParseFinite(in.Field(0), {}).has_value();
}

Expected<std::vector<Board>> ParseMarkerBoards(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const auto markers, ParseMarkerCoordinates(text, file));
  return AtPlace(BoardsWithTags(markers), {.file = file});
}

bool HasAny(const YamlNode& map, std::initializer_list<std::string_view> keys) {
  return std::ranges::any_of(keys, [&](std::string_view key) { return map.Find(key) != nullptr; });
}

// A file of one board alone; its wrong keys are then compared with those of a board.
bool IsSingleBoard(const YamlNode& root) {
  return HasAny(root, {"top_right_m", "right_bottom_m", "thickness_m", "round_holes", "tags",
                       "checker", "aprilgrid", "charuco"});
}

bool IsCamera(const YamlNode& root) {
  return HasAny(root, {"camera_matrix", "distortion_model", "distortion_coefficients",
                       "projection_matrix", "fx_px", "image_width", "K"});
}

Expected<std::vector<Board>> ParseBoardYaml(std::string_view text, const std::string& file) {
  static const std::vector<std::string> kKeys = {"boards"};
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  YamlFields in(file);
  std::vector<const YamlNode*> nodes;
  if (IsKalibrTarget(root)) {
    const Board board = ReadKalibrTarget(in, root);
    if (!in.ok()) return in.TakeError();
    return std::vector<Board>{board};
  }
  const YamlNode* list = root.Find("boards");
  if (list == nullptr && IsSingleBoard(root)) {
    nodes.push_back(&root);
  } else if (IsCamera(root)) {
    in.Fail(root.line, {},
            "expected boards, with the key 'boards', but this is a file of a camera's intrinsics");
  } else if (in.IsMap(root, "boards", kKeys) &&
             in.IsSequence(in.Require(root, "boards"), "boards", kMaxBoards)) {
    for (const YamlNode& item : list->items) nodes.push_back(&item);
    if (nodes.empty()) in.Fail(list->line, "boards", "expected at least one board");
  }
  std::vector<Board> boards;
  for (const YamlNode* node : nodes) boards.push_back(ReadBoardBlock(in, *node));
  RequireDistinctBoards(in, nodes, boards);
  if (!in.ok()) return in.TakeError();
  return boards;
}

}  // namespace

Expected<std::vector<Board>> ReadBoards(const std::filesystem::path& path) {
  return ReadWith(path, ParseBoards);
}

Expected<std::vector<Board>> ParseBoards(std::string_view text, const std::string& file) {
  return IsMarkerCoordinates(text, file) ? ParseMarkerBoards(text, file)
                                         : ParseBoardYaml(text, file);
}

std::string FormatBoards(std::span<const Board> boards) {
  YamlText out;
  out.Line("boards:");
  for (const Board& board : boards) WriteBoardBlock(out, "  ", board);
  return out.Take();
}

Expected<std::vector<Board>> BoardsWithTags(const std::vector<MarkerBoard>& markers,
                                            std::span<const int> ids) {
  std::vector<Board> boards = BoardsOf(markers);
  if (ids.size() != boards.size()) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("expected one tag id per board, {} in all, got {}; write a board "
                                 "file (YAML) for tags other than 26 and 582",
                                 boards.size(), ids.size()));
  }
  for (std::size_t i = 0; i < boards.size(); ++i) {
    const MarkerBoard& marker = markers[i];
    const double half = 0.5 * marker.marker_m;
    boards[i].tags = {{.family = "aruco_original",
                       .id = ids[i],
                       .edge_m = marker.marker_m,
                       .center_in_board_m = {-0.5 * marker.side2_m + marker.border2_m + half,
                                             0.5 * marker.side1_m - marker.border1_m - half},
                       .rotation_rad = 0.5 * std::numbers::pi}};
    if (const std::optional<BoardFault> fault = FindBoardFault(boards[i])) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("board {}{}{}: {}", i + 1, fault->field.empty() ? "" : ": ",
                                   fault->field, fault->message));
    }
  }
  return boards;
}

}  // namespace sextant
