// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/complete_boards.h"

#include <algorithm>
#include <map>
#include <utility>

namespace sextant {

std::vector<BoardPairs> CompleteBoards(std::span<const Pair3d3d> pairs) {
  std::map<std::pair<int, int>, std::vector<int>> by_board;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    by_board[{pairs[i].id.view, pairs[i].id.board}].push_back(static_cast<int>(i));
  }
  std::vector<BoardPairs> groups;
  for (const auto& [key, members] : by_board) {
    BoardPairs group{key.first, {-1, -1, -1, -1}};
    for (const int i : members) {
      const int corner = pairs[static_cast<std::size_t>(i)].id.corner;
      if (corner >= 0 && corner < kCornersPerBoard) {
        group.pairs[static_cast<std::size_t>(corner)] = i;
      }
    }
    const bool complete = members.size() == kCornersPerBoard &&
                          std::count(group.pairs.begin(), group.pairs.end(), -1) == 0;
    if (complete) groups.push_back(group);
  }
  return groups;
}

}  // namespace sextant
