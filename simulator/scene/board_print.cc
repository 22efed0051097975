// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/board_print.h"

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "geometry/board_check.h"

namespace sextant {
namespace {

// Index (from 0) of the cell in a centred row of `count` cells; none outside of the row.
std::optional<int> CellAlong(double offset_m, double cell_m, int count) {
  const double index = std::floor(offset_m / cell_m + 0.5 * count);
  if (!(index >= 0.0 && index < count)) return std::nullopt;
  return static_cast<int>(index);
}

}  // namespace

Expected<BoardPrint> BoardPrint::Make(const Board& board) {
  if (const std::optional<BoardFault> fault = FindBoardFault(board)) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("board {}{}{}: {}", board.id, fault->field.empty() ? "" : ": ",
                                 fault->field, fault->message));
  }
  BoardPrint print;
  for (const BoardTag& tag : board.tags) {
    Expected<TagPattern> pattern = MakeTagPattern(tag.family, tag.id);
    if (!pattern) {
      return MakeError(pattern.error().code,
                       fmt::format("board {}: {}", board.id, pattern.error().message));
    }
    const double cell_m = tag.edge_m / pattern->edge_cells;
    print.tags_.push_back(
        {.pattern = *std::move(pattern),
         .center_m = tag.center_in_board_m,
         .tag_x_in_board = {std::cos(tag.rotation_rad), std::sin(tag.rotation_rad)},
         .cell_m = cell_m});
  }
  if (board.checker) print.checker_ = *board.checker;
  return print;
}

PrintCell BoardPrint::At(const Eigen::Vector2d& point_in_board_m) const {
  int layer = 0;
  for (const Tag& tag : tags_) {
    ++layer;
    const Eigen::Vector2d offset = point_in_board_m - tag.center_m;
    const Eigen::Vector2d& x = tag.tag_x_in_board;
    const int cells = tag.pattern.cells;
    const auto column = CellAlong(offset.dot(x), tag.cell_m, cells);
    if (!column) continue;
    const auto row = CellAlong(offset.y() * x.x() - offset.x() * x.y(), tag.cell_m, cells);
    if (!row) continue;
    return {layer, *row * cells + *column, tag.pattern.IsWhite(*row, *column)};
  }
  if (checker_.square_m > 0.0) {
    const Eigen::Vector2d offset = point_in_board_m - checker_.center_in_board_m;
    const int columns = checker_.inner_columns + 1;
    const auto column = CellAlong(offset.x(), checker_.square_m, columns);
    const auto row = CellAlong(offset.y(), checker_.square_m, checker_.inner_rows + 1);
    if (column && row) {
      return {layer + 1, *row * columns + *column,
              ((*row + *column) % 2 == 1) != checker_.starts_white};
    }
  }
  return {};
}

}  // namespace sextant
