// SPDX-License-Identifier: Apache-2.0
#include "base/nearest_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace sextant {
namespace {

std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({substituted, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string NearestName(std::string_view wrong, std::span<const std::string> known) {
  const auto nearest = std::min_element(known.begin(), known.end(),
                                        [wrong](const std::string& a, const std::string& b) {
                                          return EditDistance(wrong, a) < EditDistance(wrong, b);
                                        });
  return nearest == known.end() ? std::string() : *nearest;
}

std::string SuggestName(std::string_view wrong, std::span<const std::string> known) {
  const std::string nearest = NearestName(wrong, known);
  if (!nearest.empty() &&
      EditDistance(wrong, nearest) <= std::max<std::size_t>(2, wrong.size() / 3)) {
    return fmt::format("did you mean '{}'?", nearest);
  }
  return fmt::format("known are {}", fmt::join(known, ", "));
}

}  // namespace sextant
