// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine/barron_loss.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace sextant {
namespace {

std::array<double, 3> At(double a, double c, double s) {
  std::array<double, 3> rho;
  BarronLoss(a, c).Evaluate(s, rho.data());
  return rho;
}

TEST(BarronLoss, DerivativesAreThoseOfTheLoss) {
  for (const double a : {2.0, 1.5, 1.0, 0.3, 0.0, -0.7, -2.0, -30.0}) {
    for (const double s : {0.01, 0.5, 3.0, 40.0}) {
      const double step = 1e-5 * s;
      const auto here = At(a, 1.7, s);
      const auto above = At(a, 1.7, s + step);
      const auto below = At(a, 1.7, s - step);
      EXPECT_NEAR(here[1], (above[0] - below[0]) / (2.0 * step), 3e-8) << a << " " << s;
      EXPECT_NEAR(here[2], (above[1] - below[1]) / (2.0 * step), 3e-8) << a << " " << s;
    }
  }
}

TEST(BarronLoss, HasItsNamedSpecialCases) {
  const double c = 1.3;
  for (const double s : {0.0, 0.2, 2.0, 50.0}) {
    const double x = s / (c * c);
    EXPECT_DOUBLE_EQ(At(2.0, c, s)[0], s);
    EXPECT_NEAR(At(1.0, c, s)[0], 2.0 * c * c * (std::sqrt(1.0 + x) - 1.0), 1e-12);
    EXPECT_NEAR(At(0.0, c, s)[0], 2.0 * c * c * std::log(1.0 + 0.5 * x), 1e-12);
    EXPECT_NEAR(At(-2.0, c, s)[0], 4.0 * s / (x + 4.0), 1e-12);
    EXPECT_NEAR(At(1e-6, c, s)[0], At(0.0, c, s)[0], 1e-4);
    EXPECT_NEAR(At(2.0 - 1e-6, c, s)[0], s, 1e-3);
  }
  for (const double a : {2.0, 1.0, 0.0, -2.0}) EXPECT_DOUBLE_EQ(At(a, c, 0.0)[1], 1.0);
}

}  // namespace
}  // namespace sextant
