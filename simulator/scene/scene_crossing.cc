// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/scene_crossing.h"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

struct Segment {
  Eigen::Vector3d from;
  Eigen::Vector3d to;
};

std::array<Segment, 4> EdgesOf(const SceneRectangle& rectangle) {
  const std::array<Eigen::Vector3d, 4> c = rectangle.Corners();
  return {{{c[0], c[1]}, {c[1], c[2]}, {c[2], c[3]}, {c[3], c[0]}}};
}

// Restricts the parameter interval [first, last] to low <= value + t slope <= high.
void Clip(double value, double slope, double low, double high, double& first, double& last) {
  if (slope == 0.0) {
    if (value < low || value > high) last = first - 1.0;
    return;
  }
  const double a = (low - value) / slope;
  const double b = (high - value) / slope;
  first = std::max(first, std::min(a, b));
  last = std::min(last, std::max(a, b));
}

// Whether part of the segment (in the box's frame) lies within +-half.
bool Enters(const Segment& segment, const Eigen::Vector3d& half) {
  double first = 0.0;
  double last = 1.0;
  const Eigen::Vector3d along = segment.to - segment.from;
  for (int axis = 0; axis < 3; ++axis) {
    Clip(segment.from[axis], along[axis], -half[axis], half[axis], first, last);
  }
  return first <= last;
}

// Whether the segment passes through the rectangle and ends more than kSceneTouch_m away on both
// sides.
bool Pierces(const Segment& segment, const SceneRectangle& rectangle) {
  const Rigid3d plane_from_world = rectangle.world_from_plane.Inverse();
  const Eigen::Vector3d a = plane_from_world * segment.from;
  const Eigen::Vector3d b = plane_from_world * segment.to;
  if (std::min(a.z(), b.z()) > -kSceneTouch_m || std::max(a.z(), b.z()) < kSceneTouch_m) {
    return false;
  }
  const Eigen::Vector3d at = a + (b - a) * (a.z() / (a.z() - b.z()));
  return std::abs(at.x()) < 0.5 * rectangle.width_m - kSceneTouch_m &&
         std::abs(at.y()) < 0.5 * rectangle.height_m - kSceneTouch_m;
}

bool AnyPierces(const SceneRectangle& of_edges, const SceneRectangle& rectangle) {
  const std::array<Segment, 4> edges = EdgesOf(of_edges);
  return std::any_of(edges.begin(), edges.end(),
                     [&](const Segment& edge) { return Pierces(edge, rectangle); });
}

// Distance between the axis, at (0, 0), and the part [first, last] of a segment in the plane.
double DistanceFromAxis(const Eigen::Vector2d& from, const Eigen::Vector2d& along, double first,
                        double last) {
  const double length2 = along.squaredNorm();
  const double nearest = length2 > 0.0 ? -from.dot(along) / length2 : first;
  return (from + std::clamp(nearest, first, last) * along).norm();
}

}  // namespace

std::array<Eigen::Vector3d, 4> SceneRectangle::Corners() const {
  const double a = 0.5 * width_m;
  const double b = 0.5 * height_m;
  return {world_from_plane * Eigen::Vector3d(-a, -b, 0.0),
          world_from_plane * Eigen::Vector3d(a, -b, 0.0),
          world_from_plane * Eigen::Vector3d(a, b, 0.0),
          world_from_plane * Eigen::Vector3d(-a, b, 0.0)};
}

double SceneRectangle::DistanceTo(const Eigen::Vector3d& point_in_world) const {
  const Eigen::Vector3d p = world_from_plane.Inverse() * point_in_world;
  return Eigen::Vector3d(std::max(0.0, std::abs(p.x()) - 0.5 * width_m),
                         std::max(0.0, std::abs(p.y()) - 0.5 * height_m), p.z())
      .norm();
}

bool Crosses(const SceneRectangle& a, const SceneRectangle& b) {
  return AnyPierces(a, b) || AnyPierces(b, a);
}

bool Crosses(const SceneRectangle& rectangle, const SceneBox& box) {
  const Rigid3d box_from_world = box.world_from_box.Inverse();
  const Eigen::Vector3d half = 0.5 * box.size_m - Eigen::Vector3d::Constant(kSceneTouch_m);
  if ((half.array() <= 0.0).any()) return false;
  const std::array<Segment, 4> edges = EdgesOf(rectangle);
  const bool enters = std::any_of(edges.begin(), edges.end(), [&](const Segment& edge) {
    return Enters({box_from_world * edge.from, box_from_world * edge.to}, half);
  });
  if (enters) return true;
  // Otherwise an edge of the box may pass through the rectangle.
  for (int axis = 0; axis < 3; ++axis) {
    for (int corner = 0; corner < 4; ++corner) {
      Eigen::Vector3d from = half;
      from[(axis + 1) % 3] *= (corner & 1) != 0 ? 1.0 : -1.0;
      from[(axis + 2) % 3] *= (corner & 2) != 0 ? 1.0 : -1.0;
      Eigen::Vector3d to = from;
      to[axis] = -to[axis];
      if (Pierces({box.world_from_box * from, box.world_from_box * to}, rectangle)) return true;
    }
  }
  return false;
}

bool Crosses(const SceneRectangle& rectangle, const SceneCylinder& cylinder) {
  const auto enters = [&](const Segment& edge) {
    const Eigen::Vector3d from = edge.from - cylinder.base_in_world;
    const Eigen::Vector3d along = edge.to - edge.from;
    double first = 0.0;
    double last = 1.0;
    Clip(from.z(), along.z(), kSceneTouch_m, cylinder.height_m - kSceneTouch_m, first, last);
    return first <= last && DistanceFromAxis(from.head<2>(), along.head<2>(), first, last) <
                                cylinder.radius_m - kSceneTouch_m;
  };
  const std::array<Segment, 4> edges = EdgesOf(rectangle);
  const Eigen::Vector3d top = cylinder.base_in_world + cylinder.height_m * Eigen::Vector3d::UnitZ();
  return std::any_of(edges.begin(), edges.end(), enters) ||
         Pierces({cylinder.base_in_world, top}, rectangle);
}

bool IsInside(const Eigen::Vector3d& point_in_world, const SceneBox& box) {
  const Eigen::Vector3d p = box.world_from_box.Inverse() * point_in_world;
  return (p.array().abs() <= 0.5 * box.size_m.array()).all();
}

bool IsInside(const Eigen::Vector3d& point_in_world, const SceneCylinder& cylinder) {
  const Eigen::Vector3d p = point_in_world - cylinder.base_in_world;
  return p.z() >= 0.0 && p.z() <= cylinder.height_m && p.head<2>().norm() <= cylinder.radius_m;
}

}  // namespace sextant
