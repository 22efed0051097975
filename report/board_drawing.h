// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/board.h"

namespace sextant {

enum class DrawingFormat { kPdf, kSvg, kPng };

/// Boards to print at true scale: outline and holes as cut lines, tags and checkerboard, a ruler of
/// 100 mm to check the printer, and `source` with the id of the board. The page is the board with a
/// margin of 20 mm. A PDF has a page for each board, the other formats hold one board.
/// Errors: kInvalidInput for a PNG of more than 200 million pixels and for several boards in a
/// format for one; kUnknownName and kInvalidInput for tags that no family has.
Expected<std::string> DrawBoards(const std::vector<Board>& boards, const std::string& source,
                                 DrawingFormat format, double png_dpi);

/// The sizes of the boards, of their pages and of their rulers, for people; of many boards, those
/// of the first three.
std::string DescribePages(const std::vector<Board>& boards);

}  // namespace sextant
