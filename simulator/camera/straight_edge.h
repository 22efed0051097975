// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

namespace sextant {

inline bool SameRadiance(double a, double b) { return std::abs(a - b) < 1e-12; }

/// A straight line that divides a unit square into two parts, determined from the radiance of its
/// corners.
struct SquareCut {
  /// Points on the border; the part with corner 0 is on the left of the line.
  std::array<Eigen::Vector2d, 2> ends;
  double first_share = 0.0;  ///< Area of the part with corner 0.
  double first = 0.0;        ///< Radiance of the part with corner 0.
  double second = 0.0;       ///< Radiance of the other part.

  /// Whether the radiance at a point is that of its part, or the point is too close to the line to
  /// decide.
  template <class RadianceAt>
  bool Explains(const Eigen::Vector2d& at, const RadianceAt& radiance_at) const {
    constexpr double kNear = 0.01;
    const Eigen::Vector2d along = (ends[1] - ends[0]).normalized();
    const Eigen::Vector2d offset = at - ends[0];
    const double beyond = along.x() * offset.y() - along.y() * offset.x();
    return std::abs(beyond) < kNear || SameRadiance(radiance_at(at), beyond > 0.0 ? first : second);
  }
};

/// The point between two points of different radiance where the radiance changes, by bisection.
template <class RadianceAt>
Eigen::Vector2d FindChange(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                           double radiance_from, const RadianceAt& radiance_at) {
  constexpr int kHalvings = 20;
  double low = 0.0;
  double high = 1.0;
  for (int step = 0; step < kHalvings; ++step) {
    const double middle = 0.5 * (low + high);
    const Eigen::Vector2d at = (1.0 - middle) * from + middle * to;
    (SameRadiance(radiance_at(at), radiance_from) ? low : high) = middle;
  }
  const double middle = 0.5 * (low + high);
  return (1.0 - middle) * from + middle * to;
}

/// Finds the cut. Corners in the order (0, 0), (1, 0), (1, 1), (0, 1). None if they do not form two
/// parts separated by one line.
template <class RadianceAt>
std::optional<SquareCut> FindSquareCut(const std::array<double, 4>& corners,
                                       const RadianceAt& radiance_at) {
  static const std::array<Eigen::Vector2d, 4> places = {
      Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0), Eigen::Vector2d(1, 1), Eigen::Vector2d(0, 1)};
  SquareCut cut{.ends = {places[0], places[0]}, .first = corners[0], .second = corners[0]};
  std::size_t changes = 0;
  double doubled_area = 0.0;  // Twice the area of the first part, by the shoelace formula.
  Eigen::Vector2d last = places[0];
  const auto add_vertex = [&](const Eigen::Vector2d& vertex) {
    doubled_area += last.x() * vertex.y() - last.y() * vertex.x();
    last = vertex;
  };
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = (i + 1) % 4;
    const bool is_first = SameRadiance(corners[i], corners[0]);
    if (is_first) add_vertex(places[i]);
    if (!is_first && SameRadiance(cut.second, cut.first)) cut.second = corners[i];
    if (!is_first && !SameRadiance(corners[i], cut.second)) return std::nullopt;
    if (is_first == SameRadiance(corners[next], corners[0])) continue;
    if (changes == 2) return std::nullopt;
    cut.ends[changes] = FindChange(places[i], places[next], corners[i], radiance_at);
    add_vertex(cut.ends[changes]);
    ++changes;
  }
  if (changes != 2) return std::nullopt;
  cut.first_share = 0.5 * doubled_area;
  return cut;
}

/// The exact mean of a unit square that is divided by one straight edge into two uniform parts.
/// None if the corners, or the radiance at the points `within`, do not agree with that.
template <class RadianceAt>
std::optional<double> MeanAcrossStraightEdge(const std::array<double, 4>& corners,
                                             std::span<const Eigen::Vector2d> within,
                                             const RadianceAt& radiance_at) {
  const std::optional<SquareCut> cut = FindSquareCut(corners, radiance_at);
  if (!cut || !std::ranges::all_of(within, [&](const Eigen::Vector2d& at) {
        return cut->Explains(at, radiance_at);
      })) {
    return std::nullopt;
  }
  return cut->first_share * cut->first + (1.0 - cut->first_share) * cut->second;
}

}  // namespace sextant
