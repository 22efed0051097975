// SPDX-License-Identifier: Apache-2.0
#include "base/random.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <set>

namespace sextant {
namespace {

TEST(Random, FollowsTheReferenceGenerator) {
  Random random(7);
  EXPECT_EQ(random.Bits(), 1021219803524665661ULL);
}

TEST(Random, NormalHasTheMomentsOfAStandardNormal) {
  Random random(1);
  constexpr int kDraws = 200000;
  double sum = 0.0;
  double squares = 0.0;
  int beyond_two = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.Normal();
    sum += x;
    squares += x * x;
    if (std::abs(x) > 2.0) ++beyond_two;
  }
  // Five standard errors each.
  EXPECT_NEAR(sum / kDraws, 0.0, 5.0 / std::sqrt(kDraws));
  EXPECT_NEAR(squares / kDraws, 1.0, 5.0 * std::sqrt(2.0 / kDraws));
  const double p = 0.0455002638963584;
  EXPECT_NEAR(static_cast<double>(beyond_two) / kDraws, p, 5.0 * std::sqrt(p * (1.0 - p) / kDraws));
}

TEST(Random, BelowIsUniform) {
  Random random(2);
  constexpr int kDraws = 70000;
  std::array<int, 7> counts{};
  for (int i = 0; i < kDraws; ++i) ++counts[random.Below(7)];
  double chi2 = 0.0;
  for (const int count : counts) chi2 += (count - 1e4) * (count - 1e4) / 1e4;
  EXPECT_LT(chi2, 27.9);  // 99.99 percent quantile at 6 degrees of freedom
}

TEST(Random, SampleIsDistinct) {
  Random random(3);
  std::array<int, 5> sample{};
  for (int trial = 0; trial < 100; ++trial) {
    random.Sample(5, sample);
    EXPECT_THAT(sample, testing::UnorderedElementsAre(0, 1, 2, 3, 4));
  }
}

TEST(DeriveSeed, DiffersInEachArgument) {
  const std::set<std::uint64_t> seeds = {DeriveSeed(1, "a", 2, 3), DeriveSeed(2, "a", 2, 3),
                                         DeriveSeed(1, "b", 2, 3), DeriveSeed(1, "a", 3, 3),
                                         DeriveSeed(1, "a", 2, 4), DeriveSeed(1, "a", 3, 2)};
  EXPECT_EQ(seeds.size(), 6U);
}

}  // namespace
}  // namespace sextant
