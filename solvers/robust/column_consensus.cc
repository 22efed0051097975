// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/column_consensus.h"

#include <Eigen/Geometry>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "solvers/kernels/column_kernel.h"
#include "solvers/robust/consensus.h"
#include "solvers/robust/shrinking_inliers.h"

namespace sextant {

Rigid3d OptimiseOnInliers(const PairColumns& pairs, const Rigid3d& cam_from_lidar,
                          double max_squared, int rounds) {
  return OptimiseOnShrinkingInliers(
      cam_from_lidar, TruncatedCost(pairs, cam_from_lidar, max_squared), rounds,
      [&](const Rigid3d& at, double) { return TruncatedCost(pairs, at, max_squared); },
      [&](const Rigid3d& at, double widening) -> std::optional<Rigid3d> {
        const InlierFit fit = FitInliers(pairs, at, widening * max_squared);
        if (!fit.fitted) return std::nullopt;
        return fit.cam_from_lidar;
      });
}

double RandomAgreementProbability(const PairColumns& pairs, double max_squared) {
  Eigen::AlignedBox3d box;
  double sigmas = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::size_t place = PairColumns::Place(i);
    const Point3<double> p = PointOf(pairs, kCamColumn, place);
    box.extend(Eigen::Vector3d(p.x, p.y, p.z));
    sigmas += std::sqrt(pairs.Column(kVarianceColumn)[place]);
  }
  const double radius = std::sqrt(max_squared) * sigmas / static_cast<double>(pairs.size());
  return RandomPointProbability(box, radius);
}

int CountDistinctAtLeast(const PairColumns& pairs, std::span<const int> indices) {
  // Marks in a table of a sixteenth's occupation: two different pairs rarely meet.
  std::vector<bool> marked(std::bit_ceil(16 * pairs.size()));
  int distinct = 0;
  for (const int i : indices) {
    std::uint64_t hash = 0;
    for (int column = 0; column < kVarianceColumn; ++column) {
      // Zero has two signs.
      const double number = pairs.Column(column)[PairColumns::Place(static_cast<std::size_t>(i))];
      hash = (hash ^ std::bit_cast<std::uint64_t>(number + 0.0)) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 29;
    }
    const std::size_t mark = hash & (marked.size() - 1);
    if (!marked[mark]) ++distinct;
    marked[mark] = true;
  }
  return distinct;
}

}  // namespace sextant
