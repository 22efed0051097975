// SPDX-License-Identifier: Apache-2.0
#include "base/nearest_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace sextant {
namespace {

// A longer text is no mistyped name; only its beginning is compared.
constexpr std::size_t kMaxCompared = 60;

// The optimal string alignment distance: insertions, deletions, substitutions, and swaps of
// neighbours.
std::size_t EditDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last;
  std::vector<std::size_t> last(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::vector<std::size_t> row(b.size() + 1, i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] =
          std::min({last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1), last[j] + 1, row[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last = std::exchange(last, std::move(row));
  }
  return last.back();
}

// Names that nobody mistypes so are not worth a suggestion: more than one edit for each three
// letters, unless one name begins with the other.
bool IsClose(std::string_view wrong, std::string_view known) {
  constexpr std::size_t kMinPrefix = 3;
  const std::string_view shorter = wrong.size() < known.size() ? wrong : known;
  const std::string_view longer = wrong.size() < known.size() ? known : wrong;
  if (shorter.size() >= kMinPrefix && longer.starts_with(shorter)) return true;
  return EditDistance(wrong, known) <= std::max<std::size_t>(1, wrong.size() / 3);
}

}  // namespace

std::string NearestName(std::string_view wrong, std::span<const std::string> known) {
  wrong = wrong.substr(0, kMaxCompared);
  const std::string* nearest = nullptr;
  std::size_t smallest = 0;
  for (const std::string& name : known) {
    const std::size_t distance = EditDistance(wrong, name);
    if (!IsClose(wrong, name) || (nearest != nullptr && distance >= smallest)) continue;
    nearest = &name;
    smallest = distance;
  }
  return nearest == nullptr ? std::string() : *nearest;
}

std::string SuggestName(std::string_view wrong, std::span<const std::string> known) {
  const std::string nearest = NearestName(wrong, known);
  if (!nearest.empty()) return fmt::format("did you mean '{}'?", nearest);
  return fmt::format("known are {}", fmt::join(known, ", "));
}

}  // namespace sextant
