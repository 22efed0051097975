// SPDX-License-Identifier: Apache-2.0
#include "io/blocks/board_json.h"

#include <nlohmann/json.hpp>

#include "io/text/degrees.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

Json Center(const Eigen::Vector2d& center) { return {center.x(), center.y()}; }

Json TagJson(const BoardTag& tag) {
  return {{"family", tag.family},
          {"id", tag.id},
          {"edge_m", tag.edge_m},
          {"center_in_board_m", Center(tag.center_in_board_m)},
          {"rotation_deg", ExactDegrees(tag.rotation_rad)}};
}

}  // namespace

Json BoardJson(const Board& board) {
  Json json = {{"id", board.id}};
  if (!board.name.empty()) json["name"] = board.name;
  json["top_right_m"] = board.top_right_m;
  json["right_bottom_m"] = board.right_bottom_m;
  json["thickness_m"] = board.thickness_m;
  if (board.hole) {
    json["hole"] = {{"width_m", board.hole->width_m},
                    {"height_m", board.hole->height_m},
                    {"center_in_board_m", Center(board.hole->center_in_board_m)}};
  }
  for (const BoardTag& tag : board.tags) json["tags"].push_back(TagJson(tag));
  if (board.checker) {
    json["checker"] = {{"inner_columns", board.checker->inner_columns},
                       {"inner_rows", board.checker->inner_rows},
                       {"square_m", board.checker->square_m},
                       {"center_in_board_m", Center(board.checker->center_in_board_m)}};
  }
  return json;
}

}  // namespace sextant
