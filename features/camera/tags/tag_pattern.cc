// SPDX-License-Identifier: Apache-2.0
#include "features/camera/tags/tag_pattern.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "base/nearest_name.h"
#include "features/camera/tags/apriltag_family.h"
#include "features/camera/tags/aruco_dictionary.h"

namespace sextant {
namespace {

TagPattern AprilTagPattern(apriltag_family_t& family, int id) {
  const AprilTagImage image = DrawAprilTag(family, id);
  TagPattern pattern{.cells = family.total_width,
                     .edge_first = (family.total_width - family.width_at_border) / 2,
                     .edge_cells = family.width_at_border,
                     .white = {}};
  for (int row = 0; row < pattern.cells; ++row) {
    for (int column = 0; column < pattern.cells; ++column) {
      pattern.white.push_back(image->buf[row * image->stride + column] > 127 ? 1 : 0);
    }
  }
  return pattern;
}

tl::unexpected<Error> UnknownFamily(std::string_view family) {
  return MakeError(ErrorCode::kUnknownName, fmt::format("no tag family '{}'; {}", family,
                                                        SuggestName(family, TagFamilies())));
}

}  // namespace

const std::vector<std::string>& TagFamilies() {
  static const std::vector<std::string> families = [] {
    std::vector<std::string> names = ArucoDictionaryNames();
    const std::vector<std::string>& others = AprilTagFamilyNames();
    names.insert(names.end(), others.begin(), others.end());
    return names;
  }();
  return families;
}

Expected<int> TagCount(std::string_view family) {
  if (const auto dictionary = FindArucoDictionary(family)) return dictionary->bytesList.rows;
  if (const AprilTagFamily april = MakeAprilTagFamily(family)) {
    return static_cast<int>(april->ncodes);
  }
  return UnknownFamily(family);
}

Expected<TagPattern> MakeTagPattern(std::string_view family, int id) {
  SEXTANT_ASSIGN_OR_RETURN(const int count, TagCount(family));
  if (id < 0 || id >= count) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("tag family {} has the ids 0 to {}, not {}", family, count - 1, id));
  }
  if (const auto dictionary = FindArucoDictionary(family)) {
    return MakeArucoPattern(*dictionary, id, ArucoBorderCells(family));
  }
  return AprilTagPattern(*MakeAprilTagFamily(family), id);
}

std::optional<int> QuarterTurns(const TagPattern& from, const TagPattern& to) {
  const int side = from.edge_cells;
  if (side != to.edge_cells) return std::nullopt;
  const auto agrees = [&](int turns) {
    for (int row = 0; row < side; ++row) {
      for (int column = 0; column < side; ++column) {
        int r = row;
        int c = column;
        for (int i = 0; i < turns; ++i) {
          const int turned = side - 1 - r;
          r = c;
          c = turned;
        }
        if (from.IsWhite(row + from.edge_first, column + from.edge_first) !=
            to.IsWhite(r + to.edge_first, c + to.edge_first)) {
          return false;
        }
      }
    }
    return true;
  };
  for (int turns = 0; turns < 4; ++turns) {
    if (agrees(turns)) return turns;
  }
  return std::nullopt;
}

}  // namespace sextant
