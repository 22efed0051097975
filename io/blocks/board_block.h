// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "geometry/board.h"
#include "io/text/yaml_fields.h"
#include "io/text/yaml_text.h"

namespace sextant {

/// A board in the files of this project (docs/formats.md), checked by FindBoardFault. Errors go to
/// `in`, at the line of the field.
Board ReadBoardBlock(YamlFields& in, const YamlNode& node);

/// The hole of a board alone, not checked.
BoardHole ReadHoleBlock(YamlFields& in, const YamlNode& node);
/// "{width_m: .., height_m: .., center_in_board_m: [..]}".
std::string YamlHole(const BoardHole& hole);

/// An error where two boards have one id, or a tag of one family is on two boards.
void RequireDistinctBoards(YamlFields& in, const std::vector<const YamlNode*>& nodes,
                           const std::vector<Board>& boards);

/// The lines of a board as an item of a list whose dash stands after `indent`; no line for what is
/// absent.
void WriteBoardBlock(YamlText& out, const std::string& indent, const Board& board);

}  // namespace sextant
