// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/edge_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "features/lidar/azimuth.h"
#include "features/lidar/edge_pairs.h"
#include "features/lidar/scan_limits.h"

namespace sextant {
namespace {

class EdgeFinder {
 public:
  EdgeFinder(const ScanRings& scan, const LidarPlane& plane, const EdgeOptions& options)
      : scan_(scan), plane_(plane), options_(options), middle_(scan.AzimuthOf(plane.origin)) {}

  // Adds the edges of one ring; `places`: its points on the plane.
  void AddRing(int ring, std::vector<std::size_t> places, std::vector<EdgePoint>& edges) const {
    std::ranges::sort(places, {}, [&](std::size_t i) { return Azimuth(i); });
    AddEdge(ring, places.front(), -1, false, edges);
    for (std::size_t i = 1; i < places.size(); ++i) {
      const double gap = Azimuth(places[i]) - Azimuth(places[i - 1]);
      if (gap <= kMaxGapSteps * scan_.azimuth_step_rad()) continue;
      if (!options_.hollow && !PassesBetween(ring, places[i - 1], places[i])) continue;
      AddEdge(ring, places[i - 1], +1, options_.hollow, edges);
      AddEdge(ring, places[i], -1, options_.hollow, edges);
    }
    AddEdge(ring, places.back(), +1, false, edges);
  }

  // Adds the end of the board between its outermost ring and the next one, `sign` +1 above or -1
  // below. There is none if the sensor has no such ring or that ring is on the plane too.
  void AddEnd(int ring, std::vector<std::size_t> places, int sign,
              std::vector<EdgePoint>& edges) const {
    const int next = ring + sign;
    if (next < 0 || next >= scan_.rings() || scan_.ring(next).empty()) return;
    std::ranges::sort(places, {}, [&](std::size_t i) { return Azimuth(i); });
    const RingPoint& last = scan_.points()[places[places.size() / 2]];
    const RingPoint& beyond = NearestInAzimuth(next, last.azimuth_rad);
    const double gap = WrapAngle(beyond.azimuth_rad - last.azimuth_rad);
    const auto on = MeetTurned(last, 0.0);
    const auto off = MeetTurned(beyond, -gap);
    if (!on || !off || (*off - *on).norm() < 1e-9) return;
    if (std::abs(gap) < kMaxGapSteps * scan_.azimuth_step_rad()) {
      const double distance = std::abs(plane_.normal.dot(beyond.point - plane_.origin));
      if (Hides(beyond) || distance < 0.01 + 3.0 * plane_.sigma_m) return;
    }
    EdgePoint edge{.in_plane = *on,
                   .outward = (*off - *on).normalized(),
                   .step_m = (*off - *on).norm(),
                   .across = true,
                   .inner = false,
                   .ring = ring,
                   .last_return = last.point};
    if (options_.correct) edge.in_plane += edge.outward * (0.5 * edge.step_m);
    SetSpot(scan_, plane_, last.point, options_, edge);
    edges.push_back(edge);
  }

 private:
  const RingPoint& NearestInAzimuth(int ring, double azimuth_rad) const {
    const std::span<const RingPoint> points = scan_.ring(ring);
    const auto after = std::ranges::lower_bound(points, azimuth_rad, {}, &RingPoint::azimuth_rad);
    const RingPoint& b = after == points.end() ? points.front() : *after;
    const RingPoint& a = after == points.begin() ? points.back() : *std::prev(after);
    const bool first = std::abs(WrapAngle(a.azimuth_rad - azimuth_rad)) <
                       std::abs(WrapAngle(b.azimuth_rad - azimuth_rad));
    return first ? a : b;
  }

  // Azimuth relative to the board, so that the seam behind the sensor has no effect.
  double Azimuth(std::size_t place) const {
    return WrapAngle(scan_.points()[place].azimuth_rad - middle_);
  }

  bool IsOn(const RingPoint& point) const {
    return std::abs(plane_.normal.dot(point.point - plane_.origin)) < 3.0 * plane_.sigma_m;
  }

  // Whether a return between two of the ring lies behind the plane: the ring leaves one object of
  // the plane and meets another.
  bool PassesBetween(int ring, std::size_t from, std::size_t to) const {
    const std::size_t first = scan_.first(ring);
    const std::size_t count = scan_.first(ring + 1) - first;
    const double clear = 0.05 + 5.0 * plane_.sigma_m;
    for (std::size_t i = from; i != to; i = first + (i - first + 1) % count) {
      if (plane_.normal.dot(scan_.points()[i].point - plane_.origin) > clear) return true;
    }
    return false;
  }

  // The next return of the ring beyond the edge; none after a gap.
  std::optional<RingPoint> Beyond(int ring, std::size_t place, int sign) const {
    const std::size_t first = scan_.first(ring);
    const std::size_t count = scan_.first(ring + 1) - first;
    const std::size_t next =
        first +
        (place - first + count + static_cast<std::size_t>(sign > 0 ? 1 : count - 1)) % count;
    const double gap = std::abs(Azimuth(next) - Azimuth(place));
    if (next == place || gap > kMaxGapSteps * scan_.azimuth_step_rad()) return std::nullopt;
    return scan_.points()[next];
  }

  std::optional<Eigen::Vector2d> MeetTurned(const RingPoint& point, double angle_rad) const {
    return plane_.Meet(Eigen::AngleAxisd(angle_rad, scan_.axis()) * point.point);
  }

  bool Hides(const RingPoint& beyond) const {
    const std::optional<Eigen::Vector2d> there = plane_.Meet(beyond.point);
    const double nearer = 0.05 + 5.0 * plane_.sigma_m;
    return there && beyond.range_m < plane_.At(*there).norm() - nearer;
  }

  void AddEdge(int ring, std::size_t place, int sign, bool inner,
               std::vector<EdgePoint>& edges) const {
    const RingPoint& last = scan_.points()[place];
    double step = scan_.azimuth_step_rad();
    if (const std::optional<RingPoint> beyond = Beyond(ring, place, sign)) {
      if (Hides(*beyond) || IsOn(*beyond)) return;
      step =
          std::clamp(std::abs(WrapAngle(beyond->azimuth_rad - last.azimuth_rad)), 0.5 * step, step);
    }
    const double correction = options_.correct ? 0.5 * step : 0.0;
    const auto edge = MeetTurned(last, sign * correction);
    const auto on = MeetTurned(last, 0.0);
    const auto off = MeetTurned(last, sign * step);
    if (!edge || !on || !off || (*off - *on).norm() < 1e-9) return;
    EdgePoint found{.in_plane = *edge,
                    .outward = (*off - *on).normalized(),
                    .step_m = (*off - *on).norm(),
                    .across = false,
                    .inner = inner,
                    .ring = ring,
                    .last_return = last.point};
    SetSpot(scan_, plane_, last.point, options_, found);
    edges.push_back(found);
  }

  const ScanRings& scan_;
  const LidarPlane& plane_;
  const EdgeOptions& options_;
  double middle_;
};

}  // namespace

double SharedSlope::Variance() const {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  for (const Place& a : places_) {
    for (const Place& b : places_) {
      const double along = b.along - a.along;
      if (along <= 0.0) continue;
      const double rise = b.distance - a.distance;
      high = std::min(high, (rise + a.half_step + b.half_step) / along);
      low = std::max(low, (rise - a.half_step - b.half_step) / along);
    }
  }
  const double open = high - low;
  return open > 0.0 && std::isfinite(open) ? open * open / 12.0 : 0.0;
}

void SetSpot(const ScanRings& scan, const LidarPlane& plane, const Eigen::Vector3d& ray,
             const EdgeOptions& options, EdgePoint& edge) {
  edge.beam = options.beam;
  if (!options.correct) edge.beam.growth = 0.0;
  const double range = ray.norm();
  const Eigen::Vector3d left = scan.axis().cross(ray).normalized();
  const Eigen::Vector3d up = ray.cross(left) / range;
  const auto center = plane.Meet(ray);
  const auto beside = plane.Meet(ray + options.beam.WidthAt(range) * left);
  const auto above = plane.Meet(ray + options.beam.HeightAt(range) * up);
  if (!center || !beside || !above) return;
  edge.spot_h = *beside - *center;
  edge.spot_v = *above - *center;
}

std::vector<EdgePoint> FindEdgePoints(const ScanRings& scan, const LidarPlane& plane,
                                      std::span<const std::size_t> on_plane,
                                      const EdgeOptions& options) {
  if (!scan.has_rings()) return FindEdgePairs(scan, plane, on_plane, options);
  const EdgeFinder finder(scan, plane, options);
  std::vector<EdgePoint> edges;
  int ring = 0;
  std::vector<std::size_t> places;
  bool first = true;
  for (std::size_t i = 0; i < on_plane.size();) {
    while (on_plane[i] >= scan.first(ring + 1)) ++ring;
    places.clear();
    while (i < on_plane.size() && on_plane[i] < scan.first(ring + 1))
      places.push_back(on_plane[i++]);
    if (first) finder.AddEnd(ring, places, -1, edges);
    first = false;
    if (places.size() >= 2) finder.AddRing(ring, places, edges);
  }
  if (!first) finder.AddEnd(ring, places, +1, edges);
  return edges;
}

}  // namespace sextant
