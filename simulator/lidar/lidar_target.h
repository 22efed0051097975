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

/// One object of a scene as a LiDAR meets it.
struct LidarTarget {
  SceneObject object = SceneObject::kBoard;
  int index = 0;
  bool is_cylinder = false;
  LidarBlock block{};        ///< A board's spans z from 0, its front, to its thickness.
  LidarCylinder cylinder{};  ///< Instead, where is_cylinder.
  Rigid3d target_from_lidar{};
  std::optional<SceneBoard> swinging{};  ///< Then target_from_lidar follows from the time.

  double white_reflectivity = 0.0;
  double black_reflectivity = 0.0;
  std::optional<BoardPrint> print{};  ///< On the front.

  /// A sphere that it never leaves, in the LiDAR frame.
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

  /// Cosine of the angle between the ray (target frame) and the normal where it enters.
  double CosIncidence(const LidarRay& ray, const LidarEntry& entry) const;

  /// Whether a ray that enters so meets the front, where the print is.
  bool OnPrint(const LidarRay& ray, const LidarEntry& entry) const {
    return print.has_value() && entry.face == 2 && ray.direction.z() > 0.0;
  }

  Rigid3d TargetFromLidar(const Rigid3d& world_from_lidar, double time_s) const;
};

/// What a scan needs of a scene: finite poses, positive sizes, at most 10000 objects. Whether it
/// makes sense for calibration is not asked. Errors: kNonFinite, kInvalidInput, naming the object.
Expected<void> CheckLidarScene(const Scene& scene);

/// Error: kInvalidInput for a LiDAR inside a box or cylinder, which is named.
Expected<void> CheckLidarOutside(const Scene& scene, const std::vector<LidarTarget>& targets);

/// Errors: those of the two checks above and of BoardPrint::Make.
Expected<std::vector<LidarTarget>> MakeLidarTargets(const Scene& scene);

}  // namespace sextant
