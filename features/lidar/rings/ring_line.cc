// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rings/ring_line.h"

#include <algorithm>
#include <limits>

#include "base/median.h"

namespace sextant {
namespace {

constexpr std::size_t kMinLines = 4;
constexpr std::size_t kMinTested = 3;  // Fewer returns of a ring do not show that it is narrow.
constexpr double kMaxSpread = 0.25;    // Spread about the line, relative to the next ring.
constexpr double kNarrowRings = 0.9;   // Share of the tested returns, on rings as narrow as that.

// A ring's line, where far from everything, and the spread of its returns about it.
struct TestedRing {
  double tangent = 0.0;
  double spread = 0.0;
  std::size_t count = 0;
};

TestedRing TestRing(const std::vector<ConePlace>& places) {
  RingLine line;
  for (const ConePlace& place : places) line.Add(place);
  std::vector<double> off;
  for (const ConePlace& place : places) {
    off.push_back(std::abs(place.tangent - line.TangentAt(place.nearness)));
  }
  return {line.TangentAt(0.0), 2.0 * UpperMedian(off), places.size()};
}

}  // namespace

bool AreNarrow(std::span<const std::vector<ConePlace>> rings) {
  std::vector<TestedRing> lines;
  for (const std::vector<ConePlace>& ring : rings) {
    if (ring.size() >= kMinTested) lines.push_back(TestRing(ring));
  }
  if (lines.size() < kMinLines) return false;
  std::ranges::sort(lines, {}, &TestedRing::tangent);
  std::size_t tested = 0;
  std::size_t narrow = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    double gap = std::numeric_limits<double>::infinity();
    if (i > 0) gap = std::min(gap, lines[i].tangent - lines[i - 1].tangent);
    if (i + 1 < lines.size()) gap = std::min(gap, lines[i + 1].tangent - lines[i].tangent);
    tested += lines[i].count;
    if (lines[i].spread < kMaxSpread * gap) narrow += lines[i].count;
  }
  return static_cast<double>(narrow) >= kNarrowRings * static_cast<double>(tested);
}

}  // namespace sextant
