// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/board.h"
#include "io/boards/marker_files.h"

namespace sextant {

/// Boards with what is printed on them: a YAML file with the list `boards`, or with one board as
/// the document itself (docs/formats.md). A `marker_coordinates.txt` of the original package is
/// taken too, as BoardsWithTags does with its usual tags.
///
/// Errors: kIo; kParse and kNonFinite with file, line and field: unknown keys, sizes that are not
/// positive, prints off the board, in its hole or over each other, a board's or a tag's id twice.
Expected<std::vector<Board>> ReadBoards(const std::filesystem::path& path);
Expected<std::vector<Board>> ParseBoards(std::string_view text, const std::string& file);

std::string FormatBoards(std::span<const Board> boards);

/// The ids of the tags that the original package's boards carry, left to right.
inline constexpr int kOriginalTagIds[] = {26, 582};

/// The boards 0, 1, ... of a `marker_coordinates.txt` with their tags of aruco_original, one id a
/// board. The tag sits towards the left corner with its own top along the edge from the right to
/// the bottom corner, as the package's session and its photos have it.
/// Error: kInvalidInput, where there are not as many ids as boards, or the tag is not on its board.
Expected<std::vector<Board>> BoardsWithTags(const std::vector<MarkerBoard>& markers,
                                            std::span<const int> ids = kOriginalTagIds);

}  // namespace sextant
