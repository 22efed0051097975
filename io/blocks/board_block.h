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

/// Reads the keys `hole` and `round_holes` of a board, where it has them; does not check them.
void ReadOpenings(YamlFields& in, const YamlNode& node, Board& board);
/// The same keys as a continuation of a map in braces: ", hole: {..}, round_holes: [..]"; those
/// that the board does not have are omitted.
std::string YamlOpenings(const Board& board);

/// Reports an error if two boards have the same id, or a tag of the same family and id appears on
/// two boards. `nodes`: those that the boards were read from.
void RequireDistinctBoards(YamlFields& in, const std::vector<const YamlNode*>& nodes,
                           const std::vector<Board>& boards);

/// Writes a board as an item of a list, its dash after `indent`; absent parts are omitted.
void WriteBoardBlock(YamlText& out, const std::string& indent, const Board& board);

}  // namespace sextant
