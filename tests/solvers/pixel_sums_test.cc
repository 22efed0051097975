// SPDX-License-Identifier: Apache-2.0
// Compares sums over eight terms at a time with sums over one term at a time.
#include "solvers/kernels/pixel_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "solvers/kernels/pair_terms.h"
#include "solvers/least_squares/term_derivatives.h"
#include "support/scenes.h"

namespace sextant {
namespace {

constexpr double kMaxSquaredSigmas = 4.0;

struct SumsCase {
  PairTerms terms;
  Rigid3d pose;

  PinholePose Pose() const { return {terms.camera, pose}; }
};

// Different focal lengths and sigmas; residuals of a few sigmas.
SumsCase MakeCase(int pairs, Random& random) {
  test::PairScene scene = test::MakeScene({.pairs = pairs, .sigma_px = 1.0}, random);
  scene.problem.camera->fy_px = 690.0;
  for (Pair2d3d& pair : scene.problem.pairs_2d3d) {
    pair.pixel = *Project(*scene.problem.camera, scene.cam_from_lidar * pair.point_in_lidar);
    pair.sigma_px = random.Uniform(0.5, 2.0);
    for (int axis = 0; axis < 2; ++axis) pair.pixel[axis] += 1.5 * pair.sigma_px * random.Normal();
  }
  SumsCase made;
  made.terms.Add(scene.problem.pairs_2d3d, *scene.problem.camera);
  made.pose = scene.cam_from_lidar;
  return made;
}

double SquaredOf(const PixelTerm& term, const SumsCase& c) {
  const auto projected = Project(c.terms.camera, c.pose * term.in_lidar);
  if (!projected) return std::numeric_limits<double>::infinity();
  return (term.inverse_sigma * (term.pixel - *projected)).squaredNorm();
}

// Sums over the terms with r^2 <= max_squared.
PixelSums OneByOne(const SumsCase& c, double max_squared) {
  PixelSums sums;
  sums.information.setZero();
  sums.gradient.setZero();
  for (const PixelTerm term : c.terms.pixels) {
    if (!(SquaredOf(term, c) <= max_squared)) continue;
    TermDerivatives<2> at;
    Differentiate(term, &c.terms.camera, c.pose.rotation.toRotationMatrix(), c.pose.translation,
                  at);
    const auto jacobian = at.Jacobian();
    sums.information += jacobian.transpose() * jacobian;
    sums.gradient += jacobian.transpose() * at.residual;
    sums.squares += at.residual.squaredNorm();
  }
  return sums;
}

void ExpectSameSlopes(const PixelSums& sums, const PixelSums& wanted) {
  const double scale = wanted.information.norm();
  EXPECT_LE((sums.information - wanted.information).norm(), 1e-13 * scale);
  EXPECT_LE((sums.gradient - wanted.gradient).norm(), 1e-11 * std::sqrt(scale));
}

double TruncatedOneByOne(const SumsCase& c) {
  double cost = 0.0;
  for (const PixelTerm term : c.terms.pixels)
    cost += std::min(kMaxSquaredSigmas, SquaredOf(term, c));
  return cost;
}

TEST(PixelSums, AreThoseOfEveryTerm) {
  Random random(1);
  for (int pairs = 1; pairs <= 26; ++pairs) {
    const SumsCase c = MakeCase(pairs, random);
    PixelSums sums;
    ASSERT_TRUE(SumPixels(c.terms.pixels.blocks(), c.Pose(), sums));
    const PixelSums wanted = OneByOne(c, std::numeric_limits<double>::infinity());
    ExpectSameSlopes(sums, wanted);
    EXPECT_NEAR(sums.squares, wanted.squares, 1e-11 * (1.0 + wanted.squares));
  }
}

TEST(PixelSums, LeaveOutOutliers) {
  Random random(2);
  for (int pairs = 1; pairs <= 26; ++pairs) {
    SumsCase c = MakeCase(pairs, random);
    // In some cases half of the points are behind the camera.
    if (pairs % 3 == 0) c.pose.translation.z() -= 3.0;
    PixelSums sums;
    const int within = SumPixelsWithin(c.terms.pixels.View(), c.Pose(), kMaxSquaredSigmas,
                                       kMaxSquaredSigmas, sums);
    int wanted = 0;
    for (const PixelTerm term : c.terms.pixels)
      wanted += SquaredOf(term, c) <= kMaxSquaredSigmas ? 1 : 0;
    EXPECT_EQ(within, wanted);
    ExpectSameSlopes(sums, OneByOne(c, kMaxSquaredSigmas));
    EXPECT_NEAR(sums.squares, TruncatedOneByOne(c), 1e-11 * (1.0 + sums.squares));
  }
}

TEST(PixelSums, SquaresAndCostAreThoseOfEveryTerm) {
  Random random(3);
  for (int pairs = 1; pairs <= 26; ++pairs) {
    SumsCase c = MakeCase(pairs, random);
    if (pairs % 3 == 0) c.pose.translation.z() -= 3.0;
    const auto blocks = c.terms.pixels.blocks();
    std::vector<double> squared(kSimdWidth * blocks.size());
    SquarePixels(blocks, c.Pose(), squared.data());
    for (std::size_t i = 0; i < c.terms.pixels.size(); ++i) {
      const double wanted = SquaredOf(c.terms.pixels[i], c);
      if (std::isfinite(wanted)) {
        EXPECT_NEAR(squared[i], wanted, 1e-11 * (1.0 + wanted));
      } else {
        EXPECT_FALSE(std::isfinite(squared[i]));
      }
    }
    const double cost = TruncatedOneByOne(c);
    constexpr double kNever = std::numeric_limits<double>::infinity();
    EXPECT_NEAR(TruncatedPixelCost(blocks, c.Pose(), kMaxSquaredSigmas, kNever), cost,
                1e-11 * cost);
    EXPECT_NEAR(ScreenedPixelCost(blocks, c.Pose(), kMaxSquaredSigmas, kNever, PixelScreen()), cost,
                1e-11 * cost);
    EXPECT_GE(TruncatedPixelCost(blocks, c.Pose(), kMaxSquaredSigmas, 0.5 * cost), 0.5 * cost);
  }
}

TEST(PixelSums, FailForAPointBehindTheCamera) {
  Random random(4);
  SumsCase c = MakeCase(20, random);
  c.pose.translation.z() -= 3.0;
  PixelSums sums;
  EXPECT_FALSE(SumPixels(c.terms.pixels.blocks(), c.Pose(), sums));
}

TEST(PixelScreen, RejectsPosesOfFewInliersAndKeepsGoodOnes) {
  Random random(5);
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const PixelScreen screen(0.5);
  int given_up = 0;
  for (int trial = 0; trial < 200; ++trial) {
    SumsCase c = MakeCase(100, random);
    const auto cost = [&] {
      return ScreenedPixelCost(c.terms.pixels.blocks(), c.Pose(), 9.0, kNever, screen);
    };
    EXPECT_TRUE(std::isfinite(cost()));
    c.pose.translation.x() += 0.3;
    given_up += std::isfinite(cost()) ? 0 : 1;
  }
  EXPECT_EQ(given_up, 200);
}

TEST(PixelTerms, KeepTheirOrder) {
  PixelTerms terms;
  for (int i = 0; i < 19; ++i) {
    terms.push_back({{i, i + 0.25}, {i + 0.5, i + 0.75, 2.0 * i}, 1.0 + i});
    EXPECT_EQ(terms.size(), static_cast<std::size_t>(i + 1));
    int k = 0;
    for (const PixelTerm term : terms) {
      EXPECT_EQ(term.pixel, Eigen::Vector2d(k, k + 0.25));
      EXPECT_EQ(term.in_lidar, Eigen::Vector3d(k + 0.5, k + 0.75, 2.0 * k));
      EXPECT_EQ(term.inverse_sigma, 1.0 + k);
      ++k;
    }
    EXPECT_EQ(k, i + 1);
  }
  terms.clear();
  EXPECT_TRUE(terms.empty());
}

}  // namespace
}  // namespace sextant
