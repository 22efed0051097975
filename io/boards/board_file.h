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

/// Reads boards with their tags and checkerboards: a YAML file with the list `boards`, or with one
/// board as the document itself (docs/formats.md), or the target file of Kalibr. A
/// `marker_coordinates.txt` of the original package is accepted too, with the tags that
/// BoardsWithTags adds by default.
///
/// Errors: kIo; kParse and kNonFinite with file, line and field: unknown keys, sizes that are not
/// positive, prints that reach off the board, into its hole or over each other, repeated ids of
/// boards or tags.
/// At most kMaxBoards boards of 1000 tags. Time is linear in the file's size and in the pairs of
/// tags on one board; memory is that of ParseYaml (io/text/yaml_node.h).
Expected<std::vector<Board>> ReadBoards(const std::filesystem::path& path);
Expected<std::vector<Board>> ParseBoards(std::string_view text, const std::string& file);

std::string FormatBoards(std::span<const Board> boards);

/// The ids of the tags on the original package's boards, left to right.
inline constexpr int kOriginalTagIds[] = {26, 582};

/// The boards 0, 1, ... of a `marker_coordinates.txt` with their tags of aruco_original, one id per
/// board. The tag is near corner 3 (left), its top along the edge from corner 1 (right) to corner 2
/// (bottom), as in the package's recorded session and its photos.
/// Error: kInvalidInput if the numbers of ids and boards differ or a tag is not on its board.
Expected<std::vector<Board>> BoardsWithTags(const std::vector<MarkerBoard>& markers,
                                            std::span<const int> ids = kOriginalTagIds);

}  // namespace sextant
