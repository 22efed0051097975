// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "io/boards/board_file.h"
#include "io/output/output_file.h"
#include "report/board_drawing.h"

namespace sextant::cli {
namespace {

struct PrintBoardOptions {
  std::string board_path{};
  std::string out{};
  std::optional<int> id{};  ///< None: every board of the file.
  double dpi = 150.0;       ///< Resolution of a PNG.
};

void Declare(PrintBoardOptions& options, Arguments& arguments) {
  arguments.Add("FILE", options.board_path, "Board YAML or marker_coordinates.txt",
                {.required = true});
  arguments.Add("--out", options.out, "Written by its extension: .pdf, .svg or .png",
                {.required = true, .writes = Writes::kFile});
  arguments.Add("--id", options.id, "One board of the file; a .pdf holds all",
                {.range = {{0, 1e9}}});
  arguments.Add("--dpi", options.dpi, "Pixels per inch of a .png",
                {.shows_default = true, .range = {{10.0, 2400.0}}});
}

Expected<DrawingFormat> FormatOf(const std::string& out) {
  const std::string extension = std::filesystem::path(out).extension().string();
  if (extension == ".pdf") return DrawingFormat::kPdf;
  if (extension == ".svg") return DrawingFormat::kSvg;
  if (extension == ".png") return DrawingFormat::kPng;
  return MakeError(ErrorCode::kInvalidOption,
                   out + ": expected a target that ends in .pdf, .svg or .png");
}

int Run(const PrintBoardOptions& options) {
  const Expected<DrawingFormat> format = FormatOf(options.out);
  if (!format) return Refuse("print-board", format.error());
  Expected<std::vector<Board>> boards = ReadBoards(options.board_path);
  if (!boards) return Refuse("print-board", boards.error());
  if (options.id) {
    std::erase_if(*boards, [&](const Board& board) { return board.id != *options.id; });
    if (boards->empty()) {
      return Refuse("print-board",
                    {ErrorCode::kInvalidOption,
                     fmt::format("{}: there is no board {}", options.board_path, *options.id)});
    }
  }
  const std::string source = std::filesystem::path(options.board_path).filename().string();
  const Expected<std::string> drawn = DrawBoards(*boards, source, *format, options.dpi);
  if (!drawn) return Refuse("print-board", drawn.error());
  if (const Expected<void> ok = WriteFileAtomically(options.out, *drawn); !ok) {
    return Refuse("print-board", ok.error());
  }
  return kAnswered;
}

}  // namespace

Command PrintBoardCommand() {
  constexpr const char* kFooter =
      "Print at 100 %, without fitting to the page, and measure the ruler.\n"
      "Example:\n  sextant print-board board.yaml --out target.pdf";
  return MakeCommand<PrintBoardOptions>("print-board",
                                        "Boards to print at true scale, with a ruler and cut lines",
                                        kFooter, Declare, Run);
}

}  // namespace sextant::cli
