// SPDX-License-Identifier: Apache-2.0
// Noise and losses of points, compared with the model's parameters.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <span>

#include "simulator/lidar/scan.h"
#include "support/lidar_scenes.h"

namespace sextant {
namespace {

using test::FullRoom;
using test::Model;
using test::Noiseless;
using test::Scan;

// A wall all around, bright and near, so that no return is weak.
Scene BrightRoom() {
  Scene scene = FullRoom();
  scene.boards.clear();
  for (SceneWall& wall : scene.walls) wall.surface.reflectivity = 0.9;
  return scene;
}

double RangeOf(const LidarModel& model, const SimulatedScan& scan, std::size_t i) {
  const LidarRing& ring = model.rings[scan.cloud.ring[i]];
  return (scan.cloud.points[i] - Eigen::Vector3d(0, 0, ring.origin_height_m)).norm();
}

// Range errors of all beams by ring.
std::map<int, std::vector<double>> RangeErrors(const LidarModel& model, std::uint64_t seed,
                                               int scan_index) {
  ScanOptions options = Noiseless();
  options.seed = seed;
  options.scan_index = scan_index;
  const SimulatedScan truth = Scan(BrightRoom(), model, options);
  options.noise = true;
  const SimulatedScan noisy = Scan(BrightRoom(), model, options);
  std::map<int, std::vector<double>> errors;
  EXPECT_EQ(truth.cloud.points.size(), noisy.cloud.points.size());
  for (std::size_t i = 0; i < truth.cloud.points.size(); ++i) {
    errors[truth.cloud.ring[i]].push_back(RangeOf(model, noisy, i) - RangeOf(model, truth, i));
  }
  return errors;
}

// No jitter of the start, so that noisy and noiseless beams coincide; no range limits.
LidarModel Steady(const char* name) {
  LidarModel model = Model(name);
  model.start_jitter_rad = 0.0;
  model.min_range_m = 0.0;
  return model;
}

TEST(ScanNoise, RangesAreNormalWithTheModelsSigmaAndBias) {
  LidarModel model = Steady("hdl32e");
  model.bias_m = 0.013;
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;
  // Deciles of the standard normal.
  constexpr std::array kDeciles = {-1.2815515655, -0.8416212336, -0.5244005127, -0.2533471031, 0.0,
                                   0.2533471031,  0.5244005127,  0.8416212336,  1.2815515655};
  std::array<int, 10> bins{};
  for (const auto& [ring, errors] : RangeErrors(model, 5, 0)) {
    for (const double error : errors) {
      const double z = (error - model.bias_m) / model.range_sigma_m;
      sum += z;
      squares += z * z;
      ++bins[static_cast<std::size_t>(std::ranges::upper_bound(kDeciles, z) - kDeciles.begin())];
      ++count;
    }
  }
  ASSERT_GT(count, 50000);
  EXPECT_NEAR(sum / count, 0.0, 4.0 / std::sqrt(count));
  EXPECT_NEAR(squares / count, 1.0, 4.0 * std::sqrt(2.0 / count));
  double chi_square = 0.0;
  for (const int bin : bins) chi_square += std::pow(bin - 0.1 * count, 2) / (0.1 * count);
  EXPECT_LT(chi_square, 33.7);  // 9 degrees of freedom, 1 in 10^4.
}

TEST(ScanNoise, EachRingOfAUnitHasAConstantBias) {
  LidarModel model = Steady("vlp16");
  model.column_period_s *= 16.0;
  const auto mean = [](const std::vector<double>& v) {
    double sum = 0.0;
    for (const double x : v) sum += x;
    return sum / static_cast<double>(v.size());
  };
  const double of_mean = model.range_sigma_m / std::sqrt(ColumnCount(model));
  double squares = 0.0;
  int count = 0;
  constexpr int kUnits = 16;
  for (int unit = 1; unit <= kUnits; ++unit) {
    const auto first = RangeErrors(model, static_cast<std::uint64_t>(unit), 0);
    const auto second = RangeErrors(model, static_cast<std::uint64_t>(unit), 1);
    for (const auto& [ring, errors] : first) {
      ASSERT_NEAR(mean(errors), mean(second.at(ring)), 5.0 * std::sqrt(2.0) * of_mean);
      squares += mean(errors) * mean(errors);
      ++count;
    }
  }
  ASSERT_EQ(count, kUnits * 16);
  const double variance = model.ring_bias_sigma_m * model.ring_bias_sigma_m + of_mean * of_mean;
  EXPECT_NEAR(squares / count / variance, 1.0, 4.0 * std::sqrt(2.0 / count));
}

TEST(ScanNoise, DimSurfacesAreFartherAndNoisier) {
  LidarModel model = Steady("vlp16");
  model.ring_bias_sigma_m = 0.0;
  Scene scene;
  scene.walls = {test::Wall("dim", test::Facing({2.0, 0.0, 0.0}, {1.0, 0.0, 0.0}), 1.0, 1.0)};
  scene.walls[0].surface.reflectivity = 0.03;
  ScanOptions options = Noiseless();
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;
  for (int k = 0; k < 10; ++k) {
    options.scan_index = k;
    options.noise = false;
    const SimulatedScan truth = Scan(scene, model, options);
    options.noise = true;
    const SimulatedScan noisy = Scan(scene, model, options);
    ASSERT_EQ(truth.cloud.points.size(), noisy.cloud.points.size());
    for (std::size_t i = 0; i < truth.cloud.points.size(); ++i) {
      const double error = RangeOf(model, noisy, i) - RangeOf(model, truth, i);
      sum += error;
      squares += error * error;
      ++count;
    }
  }
  // The effect is 1 - 0.03 / 0.15; at the wall's ends the reflectivity is up to 3 % lower.
  const double dim = 1.0 - 0.029 / 0.15;
  const double sigma = model.range_sigma_m + dim * (model.dim_sigma_m - model.range_sigma_m);
  const double mean = sum / count;
  EXPECT_NEAR(mean, dim * model.dim_bias_m, 4.0 * sigma / std::sqrt(count) + 2e-4);
  EXPECT_NEAR(std::sqrt(squares / count - mean * mean) / sigma, 1.0,
              4.0 * std::sqrt(0.5 / count) + 0.01);
}

TEST(ScanNoise, ReturnsAreLostAtTheModelsRate) {
  LidarModel model = Steady("os1_64");
  model.dropout = 0.05;
  ScanOptions options = Noiseless();
  const std::size_t all = Scan(BrightRoom(), model, options).cloud.points.size();
  options.dropouts = true;
  const std::size_t left = Scan(BrightRoom(), model, options).cloud.points.size();
  const auto n = static_cast<double>(all);
  EXPECT_NEAR(static_cast<double>(all - left), 0.05 * n, 4.0 * std::sqrt(0.05 * 0.95 * n));
}

// Detection at 10 % reflectivity up to 40 m: a surface of 5 % is always detected up to 40 / sqrt(2)
// m and never beyond 40 m.
TEST(ScanNoise, WeakReturnsAreLostWithDistance) {
  LidarModel model = Steady("os1_64");
  model.dropout = 0.0;
  ScanOptions options = Noiseless();
  options.dropouts = true;
  const auto share_at = [&](double distance_m) {
    Scene scene;
    scene.walls = {
        test::Wall("far", test::Facing({distance_m, 0.0, 0.0}, {1.0, 0.0, 0.0}), 4.0, 4.0)};
    scene.walls[0].surface.reflectivity = 0.05;
    options.dropouts = false;
    const auto all = static_cast<double>(Scan(scene, model, options).cloud.points.size());
    options.dropouts = true;
    return static_cast<double>(Scan(scene, model, options).cloud.points.size()) / all;
  };
  EXPECT_EQ(share_at(27.0), 1.0);
  EXPECT_EQ(share_at(41.0), 0.0);
  // At 32.66 m the power is 3/4 of that needed, so half of the beams, 150 or more, return.
  EXPECT_NEAR(share_at(32.66), 0.5, 4.0 * std::sqrt(0.25 / 150.0));
}

TEST(ScanNoise, RangesAreMultiplesOfTheStep) {
  const LidarModel model = Model("vlp16");
  ScanOptions options;
  const SimulatedScan scan = Scan(FullRoom(), model, options);
  bool odd = false;
  for (std::size_t i = 0; i < scan.cloud.points.size(); ++i) {
    const double steps = RangeOf(model, scan, i) / 0.002;
    ASSERT_NEAR(steps, std::round(steps), 1e-6);
    odd = odd || std::fmod(std::round(steps), 2.0) == 1.0;
    ASSERT_EQ(scan.cloud.intensity[i], std::round(scan.cloud.intensity[i]));
  }
  EXPECT_TRUE(odd);  // The step is not a multiple of the model's.
}

// White paper at normal incidence gives 80 % of the scale, black cells an eighth of that.
TEST(ScanNoise, IntensityFollowsThePrint) {
  Scene scene;
  scene.boards = {test::PlainBoard(test::Facing({1.5, 0.0, 0.0}, {1.0, 0.0, 0.0}), 1.2, 1.2)};
  scene.boards[0].board.checker =
      BoardChecker{.inner_columns = 2, .inner_rows = 2, .square_m = 0.4};
  ScanOptions options = Noiseless();
  options.divergence = true;
  const SimulatedScan scan = Scan(scene, Model("os1_64"), options);
  int black = 0;
  for (std::size_t i = 0; i < scan.cloud.points.size(); ++i) {
    const Eigen::Vector3d p = scene.boards[0].world_from_board.Inverse() * scan.cloud.points[i];
    const Eigen::Array2d squares = p.head<2>().array() / 0.4 + 1.5;
    const Eigen::Array2d to_line = (squares - squares.round()).abs();
    if (to_line.minCoeff() < 0.05 || scan.truth[i].spot_share < 1.0) continue;
    // The top-left square is black, and so is every second one.
    const Eigen::Array2i square = squares.floor().cast<int>();
    const bool is_black = square.sum() % 2 == 0;
    const double cosine = scan.cloud.points[i].x() / scan.cloud.points[i].norm();
    ASSERT_NEAR(scan.cloud.intensity[i], (is_black ? 10.0 : 80.0) * cosine, 0.5);
    black += is_black ? 1 : 0;
  }
  EXPECT_GT(black, 1000);
}

bool SameBytes(const SimulatedScan& a, const SimulatedScan& b) {
  const auto same = [](const auto& x, const auto& y) {
    return std::ranges::equal(std::as_bytes(std::span(x)), std::as_bytes(std::span(y)));
  };
  return same(a.cloud.points, b.cloud.points) && same(a.cloud.intensity, b.cloud.intensity) &&
         same(a.cloud.ring, b.cloud.ring) && same(a.cloud.time_s, b.cloud.time_s);
}

TEST(ScanNoise, TheSameSeedGivesTheSameBytesOnOneAndTwoThreads) {
  for (const char* name : {"vlp16", "livox"}) {
    const LidarModel model = Model(name);
    const ScanOptions options{.seed = 3, .scan_index = 2};
    SimulatedScan alone;
    {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
      alone = Scan(FullRoom(), model, options);
    }
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 2);
    EXPECT_TRUE(SameBytes(alone, Scan(FullRoom(), model, options))) << name;
    const ScanOptions next{.seed = 3, .scan_index = 3};
    EXPECT_FALSE(SameBytes(alone, Scan(FullRoom(), model, next))) << name;
    const ScanOptions other{.seed = 4, .scan_index = 2};
    EXPECT_FALSE(SameBytes(alone, Scan(FullRoom(), model, other))) << name;
  }
}

TEST(ScanNoise, TheStartAzimuthJitters) {
  LidarModel model = Model("vlp16");
  model.start_jitter_rad = 0.01;
  ScanOptions options = Noiseless();
  options.noise = true;
  double low = 1.0;
  double high = -1.0;
  for (int k = 0; k < 40; ++k) {
    options.scan_index = k;
    const SimulatedScan scan = Scan(BrightRoom(), model, options);
    const Eigen::Vector3d& first = scan.cloud.points[0];
    const double off = std::remainder(std::atan2(first.y(), first.x()) - model.start_azimuth_rad,
                                      2.0 * std::numbers::pi);
    low = std::min(low, off);
    high = std::max(high, off);
  }
  EXPECT_GE(low, -0.01 - 1e-9);
  EXPECT_LE(high, 0.01 + 1e-9);
  EXPECT_GT(high - low, 0.01);  // Fails for uniform draws with probability 40 / 2^39 or so.
}

}  // namespace
}  // namespace sextant
