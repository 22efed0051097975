// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/ring_clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "features/lidar/azimuth.h"

namespace sextant {
namespace {

constexpr double kSlopeWithinRing = 3.73;    // tan 75 deg.
constexpr double kSlopeBetweenRings = 1.73;  // tan 60 deg.
constexpr double kJumpsBetweenRings = 2.0;   // Range biases differ between rings, by up to 8 cm.
constexpr int kPlaces = 5;
constexpr double kMaxGapStepsInSurface = 3.5;  // A few drop-outs do not split a surface.
constexpr double kMaxGapSpacings = 6.0;        // The loops of a rosette leave gaps between them.

// The maximum gap between returns of one ring that belong together.
double MaxGap(const ScanRings& scan) {
  if (scan.has_rings()) return kMaxGapStepsInSurface * scan.azimuth_step_rad();
  return kMaxGapSpacings * std::sqrt(scan.azimuth_step_rad() * scan.elevation_step_rad());
}

bool Continues(const RingPoint& a, const RingPoint& b, double max_gap_rad,
               const ClusterOptions& options) {
  const double gap = b.azimuth_rad - a.azimuth_rad;
  const double jump = std::abs(b.range_m - a.range_m);
  return gap <= max_gap_rad && jump <= std::max(options.jump_m, kSlopeWithinRing * gap * a.range_m);
}

std::vector<RingRun> RunsOf(const ScanRings& scan, int ring, const ClusterOptions& options) {
  std::vector<RingRun> runs;
  const std::span<const RingPoint> points = scan.ring(ring);
  const double max_gap = MaxGap(scan);
  std::size_t first = 0;
  for (std::size_t i = 1; i <= points.size(); ++i) {
    if (i < points.size() && Continues(points[i - 1], points[i], max_gap, options)) continue;
    const double length = (points[i - 1].point - points[first].point).norm();
    if (length <= options.longest_run_m) {
      runs.push_back({ring, scan.first(ring) + first, i - first});
    }
    first = i;
  }
  return runs;
}

double ElevationOf(const RingPoint& point) { return std::asin(point.sine); }

// The return of a run that is nearest in azimuth.
const RingPoint& NearestInAzimuth(const ScanRings& scan, const RingRun& run, double azimuth) {
  const std::span<const RingPoint> points = scan.points().subspan(run.first, run.count);
  auto after = std::ranges::lower_bound(points, azimuth, {}, &RingPoint::azimuth_rad);
  if (after == points.end()) return points.back();
  if (after == points.begin()) return *after;
  const auto before = std::prev(after);
  return azimuth - before->azimuth_rad < after->azimuth_rad - azimuth ? *before : *after;
}

bool Touch(const ScanRings& scan, const RingRun& a, const RingRun& b,
           const ClusterOptions& options) {
  const RingPoint& a0 = scan.points()[a.first];
  const RingPoint& a1 = scan.points()[a.first + a.count - 1];
  const RingPoint& b0 = scan.points()[b.first];
  const RingPoint& b1 = scan.points()[b.first + b.count - 1];
  // Azimuths are relative to the middle of a, so that the seam has no effect.
  const double middle = 0.5 * (a0.azimuth_rad + a1.azimuth_rad);
  const double beside = scan.has_rings() ? 1.5 * scan.azimuth_step_rad() : 0.5 * MaxGap(scan);
  const double half = 0.5 * (a1.azimuth_rad - a0.azimuth_rad) + beside;
  const double from = WrapAngle(b0.azimuth_rad - middle);
  const double to = from + (b1.azimuth_rad - b0.azimuth_rad);
  if (to < -half || from > half) return false;
  const double offset = b0.azimuth_rad - (middle + from);  // 0 or a whole turn.
  const double begin = middle + std::max(from, -half);
  const double width = std::min(to, half) - std::max(from, -half);
  // Most of several places must agree: a single return may be noise or a mixed pixel.
  int agreeing = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const double azimuth = begin + width * (i + 0.5) / kPlaces;
    const RingPoint& p = NearestInAzimuth(scan, a, azimuth);
    const RingPoint& q = NearestInAzimuth(scan, b, azimuth + offset);
    const double gap = std::abs(ElevationOf(p) - ElevationOf(q)) +
                       std::abs(WrapAngle(p.azimuth_rad - q.azimuth_rad));
    const double max_jump = std::max(kJumpsBetweenRings * options.jump_m,
                                     kSlopeBetweenRings * gap * std::min(p.range_m, q.range_m));
    agreeing += std::abs(p.range_m - q.range_m) <= max_jump ? 1 : 0;
  }
  return 2 * agreeing > kPlaces;
}

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t Root(std::size_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  void Join(std::size_t a, std::size_t b) {
    const std::size_t root_a = Root(a);
    const std::size_t root_b = Root(b);
    parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
  }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace

std::vector<RingCluster> ClusterRings(const ScanRings& scan, const ClusterOptions& options) {
  std::vector<RingRun> runs;
  std::vector<std::size_t> starts = {0};
  for (int ring = 0; ring < scan.rings(); ++ring) {
    const std::vector<RingRun> more = RunsOf(scan, ring, options);
    runs.insert(runs.end(), more.begin(), more.end());
    starts.push_back(runs.size());
  }
  DisjointSets sets(runs.size());
  for (std::size_t ring = 0; ring + 1 < starts.size(); ++ring) {
    for (std::size_t a = starts[ring]; a < starts[ring + 1]; ++a) {
      // Within a ring, only the first and the last run can touch, at the seam.
      if (a + 1 == starts[ring + 1] && a > starts[ring] &&
          Touch(scan, runs[a], runs[starts[ring]], options)) {
        sets.Join(a, starts[ring]);
      }
      const std::size_t end = ring + 2 < starts.size() ? starts[ring + 2] : starts[ring + 1];
      for (std::size_t b = starts[ring + 1]; b < end; ++b) {
        if (Touch(scan, runs[a], runs[b], options)) sets.Join(a, b);
      }
    }
  }
  std::vector<std::size_t> cluster_of(runs.size(), runs.size());
  std::vector<RingCluster> clusters;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::size_t root = sets.Root(i);
    if (cluster_of[root] == runs.size()) {
      cluster_of[root] = clusters.size();
      clusters.emplace_back();
    }
    clusters[cluster_of[root]].push_back(runs[i]);
  }
  return clusters;
}

}  // namespace sextant
