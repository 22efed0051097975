// SPDX-License-Identifier: Apache-2.0
#include "io/boards/kalibr_target.h"

#include <fmt/core.h>

#include <optional>
#include <string>
#include <vector>

#include "base/text/escape.h"
#include "geometry/board_check.h"
#include "io/blocks/grid_targets.h"

namespace sextant {
namespace {

constexpr int kMaxAlongTarget = 30;
constexpr double kSidesOnPlate = 5.0;  // A plate is larger than a tag by this and more.

// The side of a tag or a square.
double SideAt(YamlFields& in, const YamlNode& root, const char* key) {
  const double side_m = in.RealAt(root, key);
  const std::optional<std::string> doubt = DoubtfulSize(kSidesOnPlate * side_m);
  if (in.ok() && doubt) {
    in.Fail(root.Find(key)->line, key, fmt::format("{} m? sizes are in metres", side_m));
  }
  return side_m;
}

Eigen::Vector2d ReadAprilGridTarget(YamlFields& in, const YamlNode& root, Board& board) {
  static const std::vector<std::string> kKeys = {"target_type",   "tagCols",    "tagRows",
                                                 "tagSize",       "tagSpacing", "top_right_m",
                                                 "right_bottom_m"};
  if (!in.IsMap(root, "aprilgrid", kKeys)) return {0.0, 0.0};
  AprilGrid grid;
  grid.columns = in.IntegerAt(root, "tagCols", 1, kMaxAlongTarget);
  grid.rows = in.IntegerAt(root, "tagRows", 1, kMaxAlongTarget);
  grid.tag_m = SideAt(in, root, "tagSize");
  grid.spacing = in.NonNegativeAt(root, "tagSpacing", 0.3);
  if (in.ok()) AddTo(grid, board);
  return grid.Size();
}

Eigen::Vector2d ReadCheckerTarget(YamlFields& in, const YamlNode& root, Board& board) {
  static const std::vector<std::string> kKeys = {
      "target_type",      "targetCols",  "targetRows",    "rowSpacingMeters",
      "colSpacingMeters", "top_right_m", "right_bottom_m"};
  if (!in.IsMap(root, "checkerboard", kKeys)) return {0.0, 0.0};
  BoardChecker checker;
  checker.inner_columns = in.IntegerAt(root, "targetCols", 2, kMaxAlongTarget);
  checker.inner_rows = in.IntegerAt(root, "targetRows", 2, kMaxAlongTarget);
  checker.square_m = SideAt(in, root, "rowSpacingMeters");
  if (in.ok() && in.RealAt(root, "colSpacingMeters") != checker.square_m) {
    in.Fail(root.Find("colSpacingMeters")->line, "colSpacingMeters",
            "expected the same as rowSpacingMeters: squares");
  }
  board.checker = checker;
  return checker.square_m * Eigen::Vector2d(checker.inner_columns + 1, checker.inner_rows + 1);
}

}  // namespace

bool IsKalibrTarget(const YamlNode& root) { return root.Find("target_type") != nullptr; }

Board ReadKalibrTarget(YamlFields& in, const YamlNode& root) {
  Board board;
  Eigen::Vector2d print = Eigen::Vector2d::Zero();
  const std::string type = in.TextAt(root, "target_type");
  if (type == "aprilgrid") {
    print = ReadAprilGridTarget(in, root, board);
  } else if (type == "checkerboard") {
    print = ReadCheckerTarget(in, root, board);
  } else if (in.ok()) {
    in.Fail(root.Find("target_type")->line, "target_type",
            fmt::format("expected aprilgrid or checkerboard, got {}", Quoted(type)));
  }
  if (!in.ok()) return board;
  board.top_right_m = in.RealAt(root, "top_right_m", print.x());
  board.right_bottom_m = in.RealAt(root, "right_bottom_m", print.y());
  if (!in.ok()) return board;
  if (const std::optional<BoardFault> fault = FindBoardFault(board)) {
    in.Fail(root.line, fault->field, fault->message);
  }
  return board;
}

}  // namespace sextant
