// SPDX-License-Identifier: Apache-2.0
#include "eval/simulator/board_print.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace sextant {
namespace {

bool IsPositive(double length_m) { return std::isfinite(length_m) && length_m > 0.0; }

Expected<void> CheckTag(const Board& board, const BoardTag& tag) {
  if (IsPositive(tag.edge_m) && tag.center_in_board_m.allFinite() &&
      std::isfinite(tag.rotation_rad)) {
    return {};
  }
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("board {}: tag {} of {} has a side of {} m at ({}, {}) m turned by "
                               "{} rad; expected a positive side and finite numbers",
                               board.id, tag.id, tag.family, tag.edge_m, tag.center_in_board_m.x(),
                               tag.center_in_board_m.y(), tag.rotation_rad));
}

Expected<void> CheckChecker(const Board& board, const BoardChecker& checker) {
  constexpr int kMaxInner = 1000;
  const auto is_count = [](int count) { return count >= 1 && count <= kMaxInner; };
  if (is_count(checker.inner_columns) && is_count(checker.inner_rows) &&
      IsPositive(checker.square_m) && checker.center_in_board_m.allFinite()) {
    return {};
  }
  return MakeError(
      ErrorCode::kInvalidInput,
      fmt::format("board {}: checkerboard of {} x {} inner corners and squares of {} m; expected 1 "
                  "to {} inner corners each way and a positive square",
                  board.id, checker.inner_columns, checker.inner_rows, checker.square_m,
                  kMaxInner));
}

// The index of the cell of a row of `count` cells, from 0; none outside.
std::optional<int> CellAlong(double offset_m, double cell_m, int count) {
  const double index = std::floor(offset_m / cell_m + 0.5 * count);
  if (!(index >= 0.0 && index < count)) return std::nullopt;
  return static_cast<int>(index);
}

}  // namespace

Expected<BoardPrint> BoardPrint::Make(const Board& board) {
  BoardPrint print;
  for (const BoardTag& tag : board.tags) {
    if (const Expected<void> ok = CheckTag(board, tag); !ok) return tl::unexpected(ok.error());
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
  if (board.checker) {
    const Expected<void> ok = CheckChecker(board, *board.checker);
    if (!ok) return tl::unexpected(ok.error());
    print.checker_ = *board.checker;
  }
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
      return {layer + 1, *row * columns + *column, (*row + *column) % 2 == 1};
    }
  }
  return {};
}

}  // namespace sextant
