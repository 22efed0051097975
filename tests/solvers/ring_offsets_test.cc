// SPDX-License-Identifier: Apache-2.0
#include "solvers/icp/ring_offsets.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "eval/extractors/scan_pairs.h"

namespace sextant {
namespace {

constexpr double kCell_rad = std::numbers::pi / 90.0;
constexpr double kRingSigma_m = 0.0095;
constexpr int kRings = 16;
constexpr int kFloorRings = 3;  ///< Hardly a wall is seen by these.

std::vector<double> TrueOffsets(std::uint64_t seed) {
  Random random(DeriveSeed(seed, "lidar_ring_bias", 0, 0));
  std::vector<double> offsets;
  for (int ring = 0; ring < kRings; ++ring) offsets.push_back(kRingSigma_m * random.Normal());
  return offsets;
}

ScanPair Room(std::uint64_t seed, double ring_bias_sigma_m) {
  LidarModel model = *FindLidarModel("vlp16");
  model.ring_bias_sigma_m = ring_bias_sigma_m;
  const Expected<ScanPair> pair = ScanRoomTwice(model, seed);
  if (!pair) ADD_FAILURE() << pair.error().message;
  return pair.value_or(ScanPair());
}

// RMS, over the rings that see walls, of the residual of a parabola fitted over the rings.
double Rms(const std::vector<double>& offsets_m) {
  constexpr int kSeen = kRings - kFloorRings;
  Eigen::MatrixXd powers(kSeen, 3);
  Eigen::VectorXd offsets(kSeen);
  for (int i = 0; i < kSeen; ++i) {
    powers.row(i) << 1.0, i, i * i;
    offsets[i] = offsets_m[static_cast<std::size_t>(i + kFloorRings)];
  }
  offsets -= powers * powers.colPivHouseholderQr().solve(offsets).eval();
  return offsets.norm() / std::sqrt(static_cast<double>(kSeen));
}

std::vector<double> Difference(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

// The weakest observable direction has a sigma of 5 mm over all rings, 1.4 mm per ring.
TEST(RingOffsets, AreFoundExceptWhatPlanesAbsorb) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const ScanPair pair = Room(seed, kRingSigma_m);
    const RingOffsets estimated = EstimateRingOffsets(ScanWindows(pair.in_target, kCell_rad),
                                                      ScanWindows(pair.in_source, kCell_rad));
    ASSERT_EQ(estimated.target_m.size(), static_cast<std::size_t>(kRings));
    EXPECT_EQ(estimated.target_m, estimated.source_m) << "of one unit";
    const std::vector<double> truth = TrueOffsets(seed);
    EXPECT_GT(Rms(truth), 0.005);
    EXPECT_LT(Rms(Difference(estimated.target_m, truth)), 0.002) << "room " << seed;
  }
}

TEST(RingOffsets, OfTwoUnitsAreSeparated) {
  const ScanPair one = Room(1, kRingSigma_m);
  const ScanPair other = Room(2, kRingSigma_m);
  const RingOffsets estimated = EstimateRingOffsets(ScanWindows(one.in_target, kCell_rad),
                                                    ScanWindows(other.in_source, kCell_rad));
  ASSERT_EQ(estimated.target_m.size(), static_cast<std::size_t>(kRings));
  ASSERT_EQ(estimated.source_m.size(), static_cast<std::size_t>(kRings));
  EXPECT_LT(Rms(Difference(estimated.target_m, TrueOffsets(1))), 0.002);
  EXPECT_LT(Rms(Difference(estimated.source_m, TrueOffsets(2))), 0.002);
}

TEST(RingOffsets, AreEmptyWithoutAny) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const ScanPair pair = Room(seed, 0.0);
    const RingOffsets estimated = EstimateRingOffsets(ScanWindows(pair.in_target, kCell_rad),
                                                      ScanWindows(pair.in_source, kCell_rad));
    EXPECT_TRUE(estimated.target_m.empty() && estimated.source_m.empty()) << "room " << seed;
  }
}

// Fewer windows than a row needs, and no surface at all.
TEST(RingOffsets, AreEmptyForPointsThatAreNoScan) {
  Random random(3);
  std::vector<Eigen::Vector3d> cloud(2000);
  for (Eigen::Vector3d& point : cloud) {
    for (int k = 0; k < 3; ++k) point[k] = random.Normal();
  }
  for (const std::size_t count : {std::size_t{1}, cloud.size()}) {
    const ScanWindows windows(std::span<const Eigen::Vector3d>(cloud).first(count), kCell_rad);
    const RingOffsets estimated = EstimateRingOffsets(windows, windows);
    EXPECT_TRUE(estimated.target_m.empty() && estimated.source_m.empty()) << count;
  }
}

}  // namespace
}  // namespace sextant
