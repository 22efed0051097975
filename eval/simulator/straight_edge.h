// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>
#include <span>

namespace sextant {

/// Brightness at a place of the unit square.
struct SquareSample {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  double radiance = 0.0;
};

inline bool SameRadiance(double a, double b) { return std::abs(a - b) < 1e-12; }

/// The mean of a unit square that one straight edge cuts into two even parts, exactly: the edge's
/// ends on the square's border by bisection, then the area of the polygon. Corners clockwise from
/// (0, 0): (0, 0), (1, 0), (1, 1), (0, 1). None where the corners or the samples within do not look
/// like that.
template <class RadianceAt>
std::optional<double> MeanAcrossStraightEdge(const std::array<double, 4>& corners,
                                             std::span<const SquareSample> within,
                                             const RadianceAt& radiance_at) {
  static const std::array<Eigen::Vector2d, 4> places = {
      Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0), Eigen::Vector2d(1, 1), Eigen::Vector2d(0, 1)};
  constexpr int kHalvings = 20;
  constexpr double kNearEdge = 0.01;
  std::optional<double> other;
  std::array<Eigen::Vector2d, 2> ends;  // Of the edge, with the first part on its left.
  std::size_t count = 0;
  double doubled_area = 0.0;  // Of the part with corner 0, by the shoelace formula.
  Eigen::Vector2d last = places[0];
  const auto add_vertex = [&](const Eigen::Vector2d& vertex) {
    doubled_area += last.x() * vertex.y() - last.y() * vertex.x();
    last = vertex;
  };
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = (i + 1) % 4;
    const bool is_first = SameRadiance(corners[i], corners[0]);
    const bool is_next_first = SameRadiance(corners[next], corners[0]);
    if (!is_first && !SameRadiance(corners[i], other.value_or(corners[i]))) return std::nullopt;
    if (!is_first) other = corners[i];
    if (is_first) add_vertex(places[i]);
    if (is_first == is_next_first) continue;
    if (count == 2) return std::nullopt;
    double low = 0.0;
    double high = 1.0;
    for (int step = 0; step < kHalvings; ++step) {
      const double middle = 0.5 * (low + high);
      const double radiance = radiance_at((1.0 - middle) * places[i] + middle * places[next]);
      (SameRadiance(radiance, corners[i]) ? low : high) = middle;
    }
    const double crossing = 0.5 * (low + high);
    ends[count] = (1.0 - crossing) * places[i] + crossing * places[next];
    add_vertex(ends[count]);
    ++count;
  }
  if (count != 2) return std::nullopt;
  add_vertex(places[0]);
  const Eigen::Vector2d along = (ends[1] - ends[0]).normalized();
  for (const SquareSample& sample : within) {
    const Eigen::Vector2d offset = sample.at - ends[0];
    const double beyond = along.x() * offset.y() - along.y() * offset.x();
    if (std::abs(beyond) < kNearEdge) continue;
    if (!SameRadiance(sample.radiance, beyond > 0.0 ? corners[0] : *other)) return std::nullopt;
  }
  const double share = 0.5 * doubled_area;
  return share * corners[0] + (1.0 - share) * *other;
}

}  // namespace sextant
