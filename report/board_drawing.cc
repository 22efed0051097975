// SPDX-License-Identifier: Apache-2.0
#include "report/board_drawing.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "base/text/printable.h"
#include "base/units.h"
#include "features/camera/tags/tag_pattern.h"

namespace sextant {
namespace {

constexpr double kPointsPerMetre = 72.0 / 0.0254;
constexpr double kBorder_m = 0.02;
constexpr double kLine_m = 0.0003;
constexpr double kRuler_m = 0.1;
constexpr double kMaxPngPixels = 2e8;

using Surface = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)>;
using Context = std::unique_ptr<cairo_t, void (*)(cairo_t*)>;

cairo_status_t Append(void* text, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

double PageWidth(const Board& board) { return board.top_right_m + 2.0 * kBorder_m; }
double PageHeight(const Board& board) { return board.right_bottom_m + 2.0 * kBorder_m; }
double RulerLength(const Board& board) {
  return std::min(kRuler_m, std::floor(board.top_right_m * 100.0) / 100.0);
}

void StrokeRectangle(cairo_t* cr, const Eigen::Vector2d& centre, double width, double height) {
  cairo_rectangle(cr, centre.x() - 0.5 * width, centre.y() - 0.5 * height, width, height);
  cairo_stroke(cr);
}

// One path for all cells, so that neighbouring cells have no seam between them.
Expected<void> DrawTag(cairo_t* cr, const BoardTag& tag) {
  SEXTANT_ASSIGN_OR_RETURN(const TagPattern pattern, MakeTagPattern(tag.family, tag.id));
  const double cell_m = tag.edge_m / pattern.edge_cells;
  cairo_save(cr);
  cairo_translate(cr, tag.center_in_board_m.x(), tag.center_in_board_m.y());
  cairo_rotate(cr, tag.rotation_rad);
  for (int row = 0; row < pattern.cells; ++row) {
    for (int column = 0; column < pattern.cells; ++column) {
      if (pattern.IsWhite(row, column)) continue;
      cairo_rectangle(cr, (column - 0.5 * pattern.cells) * cell_m,
                      (row - 0.5 * pattern.cells) * cell_m, cell_m, cell_m);
    }
  }
  cairo_fill(cr);
  cairo_restore(cr);
  return {};
}

void DrawChecker(cairo_t* cr, const BoardChecker& checker) {
  const int columns = checker.inner_columns + 1;
  const int rows = checker.inner_rows + 1;
  for (int row = 0; row < rows; ++row) {
    for (int column = (row + (checker.starts_white ? 1 : 0)) % 2; column < columns; column += 2) {
      cairo_rectangle(cr,
                      checker.center_in_board_m.x() + (column - 0.5 * columns) * checker.square_m,
                      checker.center_in_board_m.y() + (row - 0.5 * rows) * checker.square_m,
                      checker.square_m, checker.square_m);
    }
  }
  cairo_fill(cr);
}

void DrawText(cairo_t* cr, double x, double y, const std::string& text) {
  cairo_move_to(cr, x, y);
  cairo_show_text(cr, PrintableLine(text).c_str());
}

// A ruler and a label, below the board and outside the cut line.
void DrawLegend(cairo_t* cr, const Board& board, const std::string& source) {
  const double left = -0.5 * board.top_right_m;
  const double top = 0.5 * board.right_bottom_m + 0.006;
  const double ruler_m = RulerLength(board);
  cairo_move_to(cr, left, top);
  cairo_line_to(cr, left + ruler_m, top);
  for (int mm = 0; mm <= std::lround(ruler_m * 1e3); mm += 5) {
    cairo_move_to(cr, left + 1e-3 * mm, top);
    cairo_line_to(cr, left + 1e-3 * mm, top + (mm % 10 == 0 ? 0.003 : 0.0015));
  }
  cairo_stroke(cr);
  cairo_set_font_size(cr, 0.003);
  DrawText(cr, left, top + 0.0065,
           fmt::format("0 to {:.0f} mm: measure this. {}, board {}{}, {:.1f} x {:.1f} mm, corner 0 "
                       "at the top left",
                       ruler_m * 1e3, source, board.id, board.name.empty() ? "" : " " + board.name,
                       board.top_right_m * 1e3, board.right_bottom_m * 1e3));
}

Expected<void> DrawBoard(cairo_t* cr, const Board& board, const std::string& source,
                         double units_per_m) {
  cairo_save(cr);
  cairo_scale(cr, units_per_m, units_per_m);
  cairo_set_source_rgb(cr, 1.0, 1.0, 1.0);
  cairo_paint(cr);
  cairo_set_source_rgb(cr, 0.0, 0.0, 0.0);
  cairo_translate(cr, 0.5 * PageWidth(board), 0.5 * PageHeight(board));
  for (const BoardTag& tag : board.tags) {
    if (Expected<void> ok = DrawTag(cr, tag); !ok) return ok;
  }
  if (board.checker) DrawChecker(cr, *board.checker);
  cairo_set_line_width(cr, kLine_m);
  StrokeRectangle(cr, Eigen::Vector2d::Zero(), board.top_right_m, board.right_bottom_m);
  if (board.hole) {
    StrokeRectangle(cr, board.hole->center_in_board_m, board.hole->width_m, board.hole->height_m);
  }
  for (const RoundHole& hole : board.round_holes) {
    cairo_new_path(cr);
    cairo_arc(cr, hole.center_in_board_m.x(), hole.center_in_board_m.y(), hole.radius_m, 0.0,
              2.0 * std::numbers::pi);
    cairo_stroke(cr);
  }
  DrawLegend(cr, board, source);
  cairo_restore(cr);
  return {};
}

Surface MakeSurface(const Board& first, DrawingFormat format, double units_per_m,
                    std::string* text) {
  const double width = PageWidth(first) * units_per_m;
  const double height = PageHeight(first) * units_per_m;
  cairo_surface_t* surface = nullptr;
  if (format == DrawingFormat::kPdf) {
    surface = cairo_pdf_surface_create_for_stream(Append, text, width, height);
    // A fixed date, so that the same board gives the same bytes.
    cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
  } else if (format == DrawingFormat::kSvg) {
    surface = cairo_svg_surface_create_for_stream(Append, text, width, height);
  } else {
    surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::ceil(width)),
                                         static_cast<int>(std::ceil(height)));
  }
  return {surface, cairo_surface_destroy};
}

}  // namespace

Expected<std::string> DrawBoards(const std::vector<Board>& boards, const std::string& source,
                                 DrawingFormat format, double png_dpi) {
  if (boards.empty() || (format != DrawingFormat::kPdf && boards.size() > 1)) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("{}: {} boards, but a picture holds one: choose it with --id, or write a "
                    ".pdf",
                    source, boards.size()));
  }
  const double units_per_m = format == DrawingFormat::kPng ? png_dpi / 0.0254 : kPointsPerMetre;
  if (format == DrawingFormat::kPng &&
      PageWidth(boards[0]) * PageHeight(boards[0]) * units_per_m * units_per_m > kMaxPngPixels) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("{}: the board has too many pixels at {:g} dpi; lower --dpi", source, png_dpi));
  }
  std::string text;
  const Surface surface = MakeSurface(boards[0], format, units_per_m, &text);
  {
    const Context context(cairo_create(surface.get()), cairo_destroy);
    for (const Board& board : boards) {
      if (format == DrawingFormat::kPdf) {
        cairo_pdf_surface_set_size(surface.get(), PageWidth(board) * units_per_m,
                                   PageHeight(board) * units_per_m);
      }
      SEXTANT_RETURN_IF_ERROR(DrawBoard(context.get(), board, source, units_per_m));
      if (format == DrawingFormat::kPdf) cairo_show_page(context.get());
    }
  }
  if (format == DrawingFormat::kPng) {
    cairo_surface_write_to_png_stream(surface.get(), Append, &text);
  }
  cairo_surface_finish(surface.get());
  if (const cairo_status_t status = cairo_surface_status(surface.get());
      status != CAIRO_STATUS_SUCCESS && status != CAIRO_STATUS_SURFACE_FINISHED) {
    return MakeError(ErrorCode::kInvalidInput, fmt::format("{}: cannot be drawn: {}", source,
                                                           cairo_status_to_string(status)));
  }
  return text;
}

std::string DescribePages(const std::vector<Board>& boards) {
  constexpr std::size_t kMaxListed = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(boards.size(), kMaxListed); ++i) {
    const Board& board = boards[i];
    text += fmt::format(
        "{}board {} of {:g} x {:g} mm on a page of {:g} x {:g} mm with a ruler of {:g} mm",
        i == 0 ? "" : ", ", board.id, board.top_right_m * kMmPerM, board.right_bottom_m * kMmPerM,
        PageWidth(board) * kMmPerM, PageHeight(board) * kMmPerM, RulerLength(board) * kMmPerM);
  }
  if (boards.size() > kMaxListed) text += fmt::format(", and {} more", boards.size() - kMaxListed);
  return text;
}

}  // namespace sextant
