// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "io/boards/board_file.h"
#include "io/boards/board_templates.h"
#include "io/output/output_file.h"
#include "io/output/standard_output.h"
#include "report/board_drawing.h"
#include "report/wrapped_text.h"

namespace sextant::cli {
namespace {

struct PrintBoardOptions {
  std::string board_path{};
  std::string board_template{};
  std::string out{};
  std::optional<int> id{};  ///< None: every board of the file.
  double dpi = 150.0;       ///< Resolution of a PNG.
  GivenOptions given{};
};

void Declare(PrintBoardOptions& options, Arguments& arguments) {
  arguments.Add("--template", options.board_template, "A board of another program instead of FILE",
                {.choices = BoardTemplateNames()});
  arguments.Add("FILE", options.board_path, "Board YAML, Kalibr's target or marker_coordinates.txt",
                {.excludes = "--template"});
  arguments.Add("--out", options.out,
                "Written by its extension: .pdf, .svg or .png; .yaml: the board file",
                {.required = true, .writes = Writes::kFile});
  arguments.Add("--id", options.id, "One board of the file; a .pdf holds all",
                {.range = {{0, 1e9}}});
  arguments.Add("--dpi", options.dpi, "Pixels per inch of a .png",
                {.shows_default = true, .range = {{10.0, 2400.0}}});
  arguments.ReportGiven(options.given);
}

Expected<DrawingFormat> FormatOf(const std::string& out) {
  const std::string extension = std::filesystem::path(out).extension().string();
  if (extension == ".pdf") return DrawingFormat::kPdf;
  if (extension == ".svg") return DrawingFormat::kSvg;
  if (extension == ".png") return DrawingFormat::kPng;
  return MakeError(ErrorCode::kInvalidOption,
                   out + ": expected a target that ends in .pdf, .svg, .png or .yaml");
}

Expected<std::vector<Board>> BoardsOf(const PrintBoardOptions& options) {
  if (!options.board_template.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(Board board, FindBoardTemplate(options.board_template));
    return std::vector<Board>{std::move(board)};
  }
  if (!options.board_path.empty()) return ReadBoards(options.board_path);
  return MakeError(ErrorCode::kInvalidOption,
                   "expected a board file, or a board of another program with --template");
}

// The name of the file, or of the template.
std::string SourceOf(const PrintBoardOptions& options) {
  if (!options.board_template.empty()) return options.board_template;
  return std::filesystem::path(options.board_path).filename().string();
}

// The boards as a file, or drawn.
Expected<std::string> Content(const PrintBoardOptions& options, const std::vector<Board>& boards) {
  const std::filesystem::path extension = std::filesystem::path(options.out).extension();
  if (extension != ".png") {
    SEXTANT_RETURN_IF_ERROR(RefuseGiven(options.given, {"--dpi"},
                                        "is for a .png; the other formats are true to scale"));
  }
  if (extension == ".yaml") return FormatBoards(boards);
  SEXTANT_ASSIGN_OR_RETURN(const DrawingFormat format, FormatOf(options.out));
  return DrawBoards(boards, SourceOf(options), format, options.dpi);
}

std::string WrittenText(const PrintBoardOptions& options, const std::vector<Board>& boards) {
  if (std::filesystem::path(options.out).extension() == ".yaml") {
    return WroteLine(options.out, "the board file; measure what was made and correct it");
  }
  return Narrow(WroteLine(options.out, DescribePages(boards))) +
         "Print at 100 %, without fitting to the page, and check the ruler's length.\n";
}

int Run(const PrintBoardOptions& options) {
  Expected<std::vector<Board>> boards = BoardsOf(options);
  if (!boards) return Refuse("print-board", boards.error());
  if (options.id) {
    std::erase_if(*boards, [&](const Board& board) { return board.id != *options.id; });
    if (boards->empty()) {
      return Refuse("print-board",
                    {ErrorCode::kInvalidOption,
                     fmt::format("--id: {} has no board {}", SourceOf(options), *options.id)});
    }
  }
  const Expected<std::string> content = Content(options, *boards);
  if (!content) return Refuse("print-board", content.error());
  if (const Expected<void> ok = WriteFileAtomically(options.out, *content); !ok) {
    return Refuse("print-board", ok.error());
  }
  Print("{}", WrittenText(options, *boards));
  return kAnswered;
}

}  // namespace

Command PrintBoardCommand() {
  constexpr const char* kFooter =
      "Print at 100 %, without fitting to the page, and measure the ruler.\n"
      "Examples:\n  sextant print-board board.yaml --out target.pdf\n"
      "  sextant print-board --template fast_calib --out board.yaml";
  return MakeCommand<PrintBoardOptions>("print-board",
                                        "Boards to print at true scale, with a ruler and cut lines",
                                        kFooter, Declare, Run);
}

}  // namespace sextant::cli
