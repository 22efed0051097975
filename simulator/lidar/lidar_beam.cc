// SPDX-License-Identifier: Apache-2.0
#include "simulator/lidar/lidar_beam.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sextant {
namespace {

// Sub-rays of a split spot. Twelve columns resolve the position of an edge to 1.5 mm.
constexpr int kSubColumns = 12;
constexpr int kSubRows = 6;
// Samples of a spot on a print, to estimate the black fraction.
constexpr int kPrintColumns = 6;
constexpr int kPrintRows = 4;

// Maximum distance of the beams' origins from the LiDAR's origin, the apex of the cones.
constexpr double kOriginReach = 0.05;

LidarRay InTarget(const LidarBeams::Placed& placed, const LidarRay& ray) {
  return {placed.rotation * ray.origin + placed.translation, placed.rotation * ray.direction};
}

// Axes across the beam: horizontal in the LiDAR's frame, to the left as seen along the beam, and
// up.
struct SpotAxes {
  Eigen::Vector3d h;
  Eigen::Vector3d v;
};

SpotAxes AxesOf(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d h = Eigen::Vector3d(-direction.y(), direction.x(), 0.0).normalized();
  return {h, direction.cross(h)};
}

// Centre of part i of [-1/2, 1/2] divided into `count` parts.
double PartCentre(int i, int count) { return (i + 0.5) / count - 0.5; }

}  // namespace

double LidarSpot::RadiusAt(double range_m) const {
  return 0.5 * std::hypot(aperture_h_m + range_m * divergence_h_rad,
                          aperture_v_m + range_m * divergence_v_rad);
}

Expected<LidarBeams> LidarBeams::Make(const Scene& scene, const LidarSpot& spot,
                                      double pulse_length_m) {
  SEXTANT_ASSIGN_OR_RETURN(std::vector<LidarTarget> targets, MakeLidarTargets(scene));
  LidarBeams beams;
  beams.world_from_lidar_ = scene.lidar.world_from_lidar;
  beams.spot_ = spot;
  beams.pulse_length_m_ = pulse_length_m;
  for (LidarTarget& target : targets) {
    Coned coned;
    const double distance = target.center_in_lidar.norm();
    coned.spot_radius_m = spot.RadiusAt(distance + target.reach_m);
    const double reach = target.reach_m + coned.spot_radius_m + kOriginReach;
    if (reach < distance) {
      coned.axis = target.center_in_lidar / distance;
      const double sine = reach / distance;
      coned.cos_half_angle = std::sqrt((1.0 - sine) * (1.0 + sine));
    }
    coned.rotation = target.target_from_lidar.rotation.toRotationMatrix();
    coned.target = std::move(target);
    beams.targets_.push_back(std::move(coned));
  }
  return beams;
}

LidarBeams::Nearest LidarBeams::Place(const LidarRay& ray, double time_s,
                                      std::vector<Placed>& placed) const {
  placed.clear();
  double nearest_m = std::numeric_limits<double>::infinity();
  std::size_t nearest = 0;
  LidarEntry nearest_entry;
  for (const Coned& coned : targets_) {
    if (ray.direction.dot(coned.axis) < coned.cos_half_angle) continue;
    const LidarTarget& target = coned.target;
    Placed candidate{.target = &target,
                     .rotation = coned.rotation,
                     .translation = target.target_from_lidar.translation};
    if (target.swinging) {
      const Rigid3d target_from_lidar = target.TargetFromLidar(world_from_lidar_, time_s);
      candidate.rotation = target_from_lidar.rotation.toRotationMatrix();
      candidate.translation = target_from_lidar.translation;
    }
    const LidarRay in_target = InTarget(candidate, ray);
    const std::optional<double> may_enter = target.MayEnter(in_target, coned.spot_radius_m);
    if (!may_enter) continue;
    candidate.may_enter_m = *may_enter;
    if (const std::optional<LidarEntry> entry = target.Enter(in_target)) {
      if (entry->range_m < nearest_m) {
        nearest_m = entry->range_m;
        nearest_entry = *entry;
        nearest = placed.size();
      }
    }
    placed.push_back(candidate);
  }
  if (nearest_m == std::numeric_limits<double>::infinity()) return {};
  return {.placed = &placed[nearest], .entry = nearest_entry};
}

bool LidarBeams::WholeSpotOn(const Nearest& nearest, const LidarRay& ray,
                             const std::vector<Placed>& placed) const {
  const LidarTarget& target = *nearest.placed->target;
  const LidarRay in_target = InTarget(*nearest.placed, ray);
  const double radius = spot_.RadiusAt(nearest.entry.range_m);
  if (!target.AllEnter(in_target, nearest.entry, radius)) return false;
  // The longest range at which a part of the spot hits this target.
  const double cosine = target.CosIncidence(in_target, nearest.entry);
  const double farthest = nearest.entry.range_m + 2.0 * radius / std::max(cosine, 1e-3);
  return std::ranges::none_of(placed, [&](const Placed& other) {
    return &other != nearest.placed && other.may_enter_m < farthest;
  });
}

LidarEcho LidarBeams::WholeEcho(const Nearest& nearest, const LidarRay& ray) const {
  const LidarTarget& target = *nearest.placed->target;
  const LidarRay in_target = InTarget(*nearest.placed, ray);
  const double range = nearest.entry.range_m;
  LidarEcho echo;
  echo.range_m = range;
  echo.truth = {.object = target.object, .index = target.index};
  double reflectivity = target.white_reflectivity;
  if (target.OnPrint(in_target, nearest.entry)) {
    const SpotAxes axes = AxesOf(ray.direction);
    // Offset in the plane z = 0 of a ray that is parallel to the central one at the given offset.
    const auto on_plane = [&](const Eigen::Vector3d& across) -> Eigen::Vector2d {
      const Eigen::Vector3d w = nearest.placed->rotation * across;
      return w.head<2>() - in_target.direction.head<2>() * (w.z() / in_target.direction.z());
    };
    const Eigen::Vector2d h =
        on_plane(axes.h * (spot_.aperture_h_m + range * spot_.divergence_h_rad));
    const Eigen::Vector2d v =
        on_plane(axes.v * (spot_.aperture_v_m + range * spot_.divergence_v_rad));
    const Eigen::Vector2d center = (in_target.origin + range * in_target.direction).head<2>();
    int black = 0;
    for (int row = 0; row < kPrintRows; ++row) {
      for (int column = 0; column < kPrintColumns; ++column) {
        const Eigen::Vector2d point =
            center + PartCentre(column, kPrintColumns) * h + PartCentre(row, kPrintRows) * v;
        if (!target.print->At(point).is_white) ++black;
      }
    }
    echo.black_share = static_cast<double>(black) / (kPrintRows * kPrintColumns);
    reflectivity += echo.black_share * (target.black_reflectivity - target.white_reflectivity);
  }
  echo.reflectivity = reflectivity * target.CosIncidence(in_target, nearest.entry);
  echo.power = echo.reflectivity / (range * range);
  return echo;
}

bool LidarBeams::CastSubRays(const LidarRay& ray, Scratch& scratch) const {
  scratch.hits.clear();
  const SpotAxes axes = AxesOf(ray.direction);
  for (int row = 0; row < kSubRows; ++row) {
    for (int column = 0; column < kSubColumns; ++column) {
      const Eigen::Vector3d h = PartCentre(column, kSubColumns) * axes.h;
      const Eigen::Vector3d v = PartCentre(row, kSubRows) * axes.v;
      LidarRay part;
      part.origin = ray.origin + spot_.aperture_h_m * h + spot_.aperture_v_m * v;
      part.direction =
          (ray.direction + spot_.divergence_h_rad * h + spot_.divergence_v_rad * v).normalized();
      SubHit hit;
      hit.range_m = std::numeric_limits<double>::infinity();
      for (const Placed& placed : scratch.placed) {
        const LidarRay in_target = InTarget(placed, part);
        const std::optional<LidarEntry> entry = placed.target->Enter(in_target);
        if (!entry || entry->range_m >= hit.range_m) continue;
        const LidarTarget& target = *placed.target;
        const Eigen::Vector3d point = in_target.origin + entry->range_m * in_target.direction;
        const bool black = target.OnPrint(in_target, *entry) &&
                           !target.print->At(Eigen::Vector2d(point.head<2>())).is_white;
        const double diffuse = black ? target.black_reflectivity : target.white_reflectivity;
        hit = {.range_m = entry->range_m,
               .reflectivity = diffuse * target.CosIncidence(in_target, *entry),
               .target = &target,
               .face = entry->face,
               .black = black};
      }
      if (hit.target != nullptr) scratch.hits.push_back(hit);
    }
  }
  return !scratch.hits.empty();
}

std::optional<LidarEcho> LidarBeams::Cast(const LidarRay& ray, double time_s,
                                          Scratch& scratch) const {
  const Nearest nearest = Place(ray, time_s, scratch.placed);
  if (scratch.placed.empty()) return std::nullopt;
  const bool hit = nearest.placed != nullptr;
  if (spot_.IsPoint() && !hit) return std::nullopt;
  if (hit && (spot_.IsPoint() || WholeSpotOn(nearest, ray, scratch.placed))) {
    return WholeEcho(nearest, ray);
  }
  if (!CastSubRays(ray, scratch)) return std::nullopt;
  LidarEcho echo = StrongestEcho(scratch.hits, kSubColumns * kSubRows, pulse_length_m_);
  // All sub-rays hit one face, so the central ray's range is exact.
  const bool one_face = std::ranges::all_of(scratch.hits, [&](const SubHit& sub) {
    return hit && sub.target == nearest.placed->target && sub.face == nearest.entry.face;
  });
  if (one_face && echo.truth.spot_share == 1.0) echo.range_m = nearest.entry.range_m;
  return echo;
}

}  // namespace sextant
