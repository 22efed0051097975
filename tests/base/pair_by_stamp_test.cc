// SPDX-License-Identifier: Apache-2.0
#include "base/pair_by_stamp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "base/random.h"

namespace sextant {
namespace {

using Stamps = std::vector<std::int64_t>;
using testing::ElementsAre;

TEST(PairByStamp, TakesTheNearestAndEachOnce) {
  const StampPairs found = PairByStamp(Stamps{300, 100, 200}, Stamps{110, 195, 95, 900}, 50);
  ASSERT_EQ(found.pairs.size(), 2U);
  EXPECT_EQ(found.pairs[0].first, 1U);
  EXPECT_EQ(found.pairs[0].second, 2U);
  EXPECT_EQ(found.pairs[0].difference_ns, -5);
  EXPECT_EQ(found.pairs[1].first, 2U);
  EXPECT_EQ(found.pairs[1].second, 1U);
  EXPECT_THAT(found.unpaired_first, ElementsAre(0));
  EXPECT_THAT(found.unpaired_second, ElementsAre(0, 3));
}

TEST(PairByStamp, ToleranceIsIncluded) {
  EXPECT_EQ(PairByStamp(Stamps{0}, Stamps{50}, 50).pairs.size(), 1U);
  EXPECT_EQ(PairByStamp(Stamps{0}, Stamps{51}, 50).pairs.size(), 0U);
  EXPECT_TRUE(PairByStamp(Stamps{}, Stamps{}, 50).pairs.empty());
  EXPECT_EQ(PairByStamp(Stamps{}, Stamps{5}, 50).unpaired_second.size(), 1U);
}

// Implements the definition directly: repeatedly takes the closest remaining pair.
std::vector<std::int64_t> ByDefinition(Stamps first, Stamps second, std::int64_t tolerance) {
  std::vector<std::int64_t> distances;
  while (true) {
    std::int64_t best = std::numeric_limits<std::int64_t>::max();
    std::size_t a = 0;
    std::size_t b = 0;
    for (std::size_t i = 0; i < first.size(); ++i) {
      for (std::size_t j = 0; j < second.size(); ++j) {
        const std::int64_t distance = std::abs(first[i] - second[j]);
        if (distance >= best) continue;
        best = distance;
        a = i;
        b = j;
      }
    }
    if (best > tolerance || first.empty() || second.empty()) return distances;
    distances.push_back(best);
    first.erase(first.begin() + static_cast<std::ptrdiff_t>(a));
    second.erase(second.begin() + static_cast<std::ptrdiff_t>(b));
  }
}

TEST(PairByStamp, IsTheGreedyOfItsDefinition) {
  Random random(5);
  for (int trial = 0; trial < 300; ++trial) {
    // Stamps that are powers of two apart have distinct distances, so the result is unique.
    Stamps first;
    Stamps second;
    std::int64_t time = 0;
    for (int i = 0; i < 14; ++i) {
      time += std::int64_t{1} << random.Below(40);
      (random.Below(2) == 0 ? first : second)
          .push_back(time * 64 + (std::int64_t{1} << random.Below(6)));
    }
    const std::int64_t tolerance = std::int64_t{1} << random.Below(46);
    const std::vector<std::int64_t> expected = ByDefinition(first, second, tolerance);
    StampPairs found = PairByStamp(first, second, tolerance);
    std::vector<std::int64_t> distances;
    for (const StampPair& pair : found.pairs) distances.push_back(std::abs(pair.difference_ns));
    std::sort(distances.begin(), distances.end());
    EXPECT_EQ(distances, expected);
    EXPECT_EQ(found.unpaired_first.size() + found.pairs.size(), first.size());
    EXPECT_EQ(found.unpaired_second.size() + found.pairs.size(), second.size());
  }
}

}  // namespace
}  // namespace sextant
