// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/corner_extractor.h"

#include <fmt/core.h>

#include "base/nearest_name.h"
#include "features/lidar/corner_geometry.h"

namespace sextant {
namespace {

struct ExtractorEntry {
  CornerExtractorInfo info;
  Expected<LidarCorners> (*extract)(const BoardPatch&, const Board&);
};

const std::vector<ExtractorEntry>& ExtractorEntries() {
  static const std::vector<ExtractorEntry> entries = {
      {{"rectangle", "the known size fitted to the edge points within the board's plane"},
       CornersByRectangle},
      {{"plane_lines", "edge lines within the board's plane, intersected"}, CornersByPlaneLines},
      {{"lines3d", "four 3D lines by RANSAC, as Dhall et al. 2017; uses neither plane nor size"},
       [](const BoardPatch& patch, const Board& board) {
         return CornersByLines3d(patch, board, true);
       }},
      {{"lines3d_raw", "the same without refitting, as in the original package"},
       [](const BoardPatch& patch, const Board& board) {
         return CornersByLines3d(patch, board, false);
       }},
  };
  return entries;
}

}  // namespace

const std::vector<CornerExtractorInfo>& CornerExtractors() {
  static const std::vector<CornerExtractorInfo> infos = [] {
    std::vector<CornerExtractorInfo> list;
    for (const ExtractorEntry& entry : ExtractorEntries()) list.push_back(entry.info);
    return list;
  }();
  return infos;
}

Expected<LidarCorners> ExtractCorners(std::string_view extractor, const BoardPatch& patch,
                                      const Board& board) {
  std::vector<std::string> names;
  for (const ExtractorEntry& entry : ExtractorEntries()) {
    if (extractor == entry.info.name) return entry.extract(patch, board);
    names.emplace_back(entry.info.name);
  }
  return MakeError(ErrorCode::kUnknownName, fmt::format("no corner extractor '{}'; {}", extractor,
                                                        SuggestName(extractor, names)));
}

}  // namespace sextant
