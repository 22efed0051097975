// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"
#include "simulator/lidar/lidar_shape.h"
#include "simulator/lidar/scan.h"
#include "simulator/scene/board_print.h"

namespace sextant {

/// One object of a scene, prepared for casting LiDAR beams.
struct LidarTarget {
  SceneObject object = SceneObject::kBoard;
  int index = 0;
  bool is_cylinder = false;
  LidarBlock block{};        ///< For a board, z extends from 0 (the front) to its thickness.
  LidarCylinder cylinder{};  ///< Used instead of `block` if is_cylinder.
  Rigid3d target_from_lidar{};
  std::optional<SceneBoard> swinging{};  ///< If set, target_from_lidar depends on the time.

  double white_reflectivity = 0.0;
  double black_reflectivity = 0.0;
  std::optional<BoardPrint> print{};  ///< Print on the front.

  /// Bounding sphere at all times, in the LiDAR frame.
  Eigen::Vector3d center_in_lidar = Eigen::Vector3d::Zero();
  double reach_m = 0.0;

  std::optional<LidarEntry> Enter(const LidarRay& ray) const {
    return is_cylinder ? cylinder.Enter(ray) : block.Enter(ray);
  }
  bool AllEnter(const LidarRay& ray, const LidarEntry& entry, double radius_m) const {
    return is_cylinder ? cylinder.AllEnter(ray, entry, radius_m)
                       : block.AllEnter(ray, entry, radius_m);
  }
  std::optional<double> MayEnter(const LidarRay& ray, double radius_m) const {
    return is_cylinder ? cylinder.MayEnter(ray, radius_m) : block.MayEnter(ray, radius_m);
  }

  /// Cosine of the angle between the ray (target frame) and the normal at the entry point.
  double CosIncidence(const LidarRay& ray, const LidarEntry& entry) const;

  /// Whether the entry is on the front, which carries the print.
  bool OnPrint(const LidarRay& ray, const LidarEntry& entry) const {
    return print.has_value() && entry.face == 2 && ray.direction.z() > 0.0;
  }

  Rigid3d TargetFromLidar(const Rigid3d& world_from_lidar, double time_s) const;
};

/// Checks what a scan requires of a scene: finite poses, positive sizes, at most 10000 objects.
/// Does not check whether the scene is useful for calibration. Errors: kNonFinite, kInvalidInput;
/// messages name the object.
Expected<void> CheckLidarScene(const Scene& scene);

/// Error: kInvalidInput if the LiDAR is inside a box or cylinder; the message names it.
Expected<void> CheckLidarOutside(const Scene& scene, const std::vector<LidarTarget>& targets);

/// Errors: those of the two checks above and of BoardPrint::Make.
Expected<std::vector<LidarTarget>> MakeLidarTargets(const Scene& scene);

}  // namespace sextant
