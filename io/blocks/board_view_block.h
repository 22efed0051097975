// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/board.h"
#include "geometry/board_view.h"
#include "geometry/lidar_errors.h"
#include "io/text/yaml_fields.h"
#include "io/text/yaml_text.h"

namespace sextant {

/// Reads the list `board_views` of a problem file and checks it by CheckBoardViews against the
/// file's boards. Errors go to `in`, at the line of the field or the view.
std::vector<BoardView> ReadBoardViews(YamlFields& in, const YamlNode& list,
                                      std::span<const Board> boards);

/// The map `lidar_errors` of a problem file, and back.
LidarErrorModel ReadLidarErrors(YamlFields& in, const YamlNode& node);
void WriteLidarErrors(YamlText& out, const LidarErrorModel& errors);

/// What both sensors, or one of them, measured: the keys printed, the face returns by `face_key`
/// with range_sigma_m and face_rings, and edges. Absent keys leave the view as it is.
void ReadObservations(YamlFields& in, const YamlNode& node, const std::string& face_key,
                      BoardView& view);
/// Writes the lines of these keys after `indent`; the items of printed without their key.
void WriteObservations(YamlText& out, const std::string& indent, const std::string& face_key,
                       const BoardView& view);

/// Writes a view as an item of that list; reading it again gives the same bits.
void WriteBoardView(YamlText& out, const BoardView& view);

}  // namespace sextant
