// SPDX-License-Identifier: Apache-2.0
#include "features/scene/scan_sweeps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/median.h"
#include "features/lidar/rings/scan_rings.h"

namespace sextant {
namespace {

constexpr double kMinRange_m = 0.5;
constexpr std::size_t kMinTurns = 4;
constexpr std::size_t kMaxTurns = 256;
constexpr std::size_t kMinPerTurn = 50;
constexpr double kMaxStep_rad = 0.012;

// Empty unless the points are listed one turn after another, in small steps.
ScanSweeps FindTurns(const PointCloud& scan) {
  ScanSweeps turns(1);
  std::vector<double> steps;
  const Eigen::Vector3d* last = nullptr;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3d& point = scan.points[i];
    if (!point.allFinite() || point.norm() < kMinRange_m) continue;
    if (last != nullptr) {
      const double turned = std::atan2(point.y(), point.x()) - std::atan2(last->y(), last->x());
      const bool wraps = std::abs(turned) > std::numbers::pi;
      if (wraps && turns.back().size() > kMinPerTurn) turns.emplace_back();
      if (i % 16 == 0) steps.push_back((point.normalized() - last->normalized()).norm());
    }
    last = &point;
    turns.back().push_back(static_cast<int>(i));
  }
  const bool few = turns.size() < kMinTurns || turns.size() > kMaxTurns || steps.empty();
  if (few || UpperMedian(steps) > kMaxStep_rad) return {};
  return turns;
}

}  // namespace

Expected<ScanSweeps> FindSweeps(const PointCloud& scan) {
  if (scan.ring.empty()) {
    if (ScanSweeps turns = FindTurns(scan); !turns.empty()) return turns;
  }
  SEXTANT_ASSIGN_OR_RETURN(const ScanRings rings, ScanRings::Build(scan));
  ScanSweeps sweeps;
  for (int i = 0; i < rings.rings(); ++i) {
    std::vector<int>& sweep = sweeps.emplace_back();
    for (const RingPoint& point : rings.ring(i)) {
      if (point.range_m >= kMinRange_m) sweep.push_back(point.index);
    }
  }
  return sweeps;
}

}  // namespace sextant
