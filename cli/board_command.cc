// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "cli/commands.h"
#include "cli/load.h"
#include "io/boards/board_file.h"
#include "io/text/text_file.h"
#include "report/board_drawing.h"

namespace sextant::cli {
namespace {

Expected<DrawingFormat> FormatOf(const std::string& out) {
  const std::string extension = std::filesystem::path(out).extension().string();
  if (extension == ".pdf") return DrawingFormat::kPdf;
  if (extension == ".svg") return DrawingFormat::kSvg;
  if (extension == ".png") return DrawingFormat::kPng;
  return MakeError(ErrorCode::kInvalidOption,
                   out + ": expected a target that ends in .pdf, .svg or .png");
}

}  // namespace

int RunBoard(const BoardOptions& options) {
  const Expected<DrawingFormat> format = FormatOf(options.out);
  if (!format) return Refuse("board", format.error());
  Expected<std::vector<Board>> boards = ReadBoards(options.board_path);
  if (!boards) return Refuse("board", boards.error());
  if (options.id) {
    std::erase_if(*boards, [&](const Board& board) { return board.id != *options.id; });
    if (boards->empty()) {
      return Refuse("board",
                    {ErrorCode::kInvalidOption,
                     fmt::format("{}: there is no board {}", options.board_path, *options.id)});
    }
  }
  const std::string source = std::filesystem::path(options.board_path).filename().string();
  const Expected<std::string> drawn = DrawBoards(*boards, source, *format, options.dpi);
  if (!drawn) return Refuse("board", drawn.error());
  if (const Expected<void> ok = WriteFileAtomically(options.out, *drawn); !ok) {
    return Refuse("board", ok.error());
  }
  return kAnswered;
}

}  // namespace sextant::cli
