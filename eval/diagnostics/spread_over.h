// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace sextant {

/// Up to `most` elements, evenly spread over the list.
template <class Element>
std::vector<Element> SpreadOver(const std::vector<Element>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<Element> spread;
  for (std::size_t i = 0; i < most; ++i) spread.push_back(all[i * all.size() / most]);
  return spread;
}

}  // namespace sextant
