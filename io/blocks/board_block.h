// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "geometry/board.h"
#include "io/text/yaml_fields.h"
#include "io/text/yaml_text.h"

namespace sextant {

/// Reads a board as every file of this project states it (docs/formats.md) and checks it by
/// FindBoardFault. Errors go to `in`, at the line of the field.
Board ReadBoardBlock(YamlFields& in, const YamlNode& node);

/// Reads the hole of a board; does not check it.
BoardHole ReadHoleBlock(YamlFields& in, const YamlNode& node);
/// "{width_m: .., height_m: .., center_in_board_m: [..]}".
std::string YamlHole(const BoardHole& hole);

/// Reads the list of a board's round holes; does not check them.
std::vector<RoundHole> ReadRoundHoles(YamlFields& in, const YamlNode& list);
/// "{radius_m: .., center_in_board_m: [..]}".
std::string YamlRoundHole(const RoundHole& hole);

/// Reports an error if two boards have the same id, or a tag of the same family and id appears on
/// two boards. `nodes`: those that the boards were read from.
void RequireDistinctBoards(YamlFields& in, const std::vector<const YamlNode*>& nodes,
                           const std::vector<Board>& boards);

/// Writes a board as an item of a list, its dash after `indent`; absent parts are omitted.
void WriteBoardBlock(YamlText& out, const std::string& indent, const Board& board);

}  // namespace sextant
