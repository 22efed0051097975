// SPDX-License-Identifier: Apache-2.0
// Pairs are gathered eight at a time: every term must equal its pair at every position.
#include "solvers/kernels/pair_terms.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace sextant {
namespace {

std::vector<Pair2d3d> RandomPairs(std::size_t count, double sigma_px, Random& random) {
  std::vector<Pair2d3d> pairs(count);
  for (Pair2d3d& pair : pairs) {
    pair.pixel = {random.Normal(), 7.0};
    for (int k = 0; k < 3; ++k) pair.point_in_lidar[k] = random.Normal();
    pair.sigma_px = sigma_px;
    pair.id = {.view = -1, .board = 1 << 30, .corner = 3};
  }
  return pairs;
}

void ExpectTermOf(const Pair2d3d& pair, double sigma_px, const PixelTerm& term) {
  EXPECT_EQ(term.pixel, pair.pixel);
  EXPECT_EQ(term.in_lidar, pair.point_in_lidar);
  EXPECT_EQ(term.inverse_sigma, 1.0 / sigma_px);
}

TEST(PairTerms, EqualTheirPairsAtEveryPosition) {
  Random random(1);
  for (std::size_t first = 0; first < 20; ++first) {
    for (const std::size_t second : {0U, 1U, 7U, 8U, 9U, 23U}) {
      const std::vector<Pair2d3d> stated = RandomPairs(first, 0.3, random);
      const std::vector<Pair2d3d> unstated = RandomPairs(second, 0.0, random);
      PairTerms terms;
      terms.Add(stated, {});
      EXPECT_TRUE(terms.noise_known);
      terms.Add(unstated, {});
      EXPECT_EQ(terms.noise_known, second == 0);
      ASSERT_EQ(terms.pixels.size(), first + second);
      for (std::size_t i = 0; i < first; ++i) ExpectTermOf(stated[i], 0.3, terms.pixels[i]);
      for (std::size_t i = 0; i < second; ++i) {
        ExpectTermOf(unstated[i], 1.0, terms.pixels[first + i]);
      }
    }
  }
}

TEST(PairTerms, PaddingRepeatsATermAndAddsNothing) {
  Random random(2);
  const std::vector<Pair2d3d> pairs = RandomPairs(11, 1.0, random);
  PairTerms terms;
  terms.Add(pairs, {});
  ASSERT_EQ(terms.pixels.blocks().size(), 2U);
  const PixelBlock& last = terms.pixels.blocks()[1];
  for (std::size_t k = 3; k < kSimdWidth; ++k) {
    EXPECT_EQ(last.x[k], last.x[0]);
    EXPECT_EQ(last.z[k], last.z[0]);
    EXPECT_EQ(last.inverse_sigma[k], 0.0);
  }
}

}  // namespace
}  // namespace sextant
