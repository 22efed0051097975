// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/error.h"
#include "geometry/point_cloud.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/scene/scene.h"

namespace sextant {

enum class SceneObject : std::uint8_t { kBoard, kWall, kBox, kCylinder };

/// The true origin of a point.
struct PointTruth {
  SceneObject object = SceneObject::kBoard;
  int index = 0;          ///< Index into the scene's list of such objects.
  double spot_share = 1;  ///< Fraction of the beam's spot on this face; 1: no edge within the spot.
  bool mixed = false;     ///< The range is a mixture of this face's and another's.
};

struct ScanOptions {
  std::uint64_t seed = 1;
  /// Seed of what is constant for one unit of the model, the biases of its rings; none: `seed`.
  std::optional<std::uint64_t> unit{};
  int scan_index = 0;  ///< Distinguishes the scans of one seed.
  /// Time after the session's start; determines the pose of swinging boards.
  double start_time_s = 0.0;
  bool noise = true;         ///< Range noise, biases and jitter of the start azimuth.
  bool quantisation = true;  ///< Quantisation of range and intensity.
  bool divergence = true;    ///< If false, a beam is a line, and there are no mixed points.
  bool dropouts = true;      ///< Random losses and losses of weak returns.
  bool truth = false;        ///< Fill SimulatedScan::truth.
};

struct SimulatedScan {
  PointCloud cloud;               ///< Column by column; `ring` is empty for a rosette.
  std::vector<PointTruth> truth;  ///< One per point, if requested.
};

/// Simulates one revolution of `model` at scene.lidar.world_from_lidar (scene.lidar.model is
/// ignored).
///
/// Every beam is emitted at its own time, so swinging boards are distorted. A spot within one
/// surface gives the range of its central ray, exactly on the surface if noise and quantisation are
/// off. A spot across an edge is divided into sub-rays of equal power: a surface's echo is the sum
/// of reflectivity cos(incidence) / range^2 over its sub-rays, echoes closer than a pulse length
/// merge to their power-weighted mean, and the strongest echo is returned along the central ray.
/// Objects therefore appear up to half a spot too wide if there is nothing bright behind them.
///
/// The same scene, model and options give the same bits on any number of threads. Errors, before
/// any beam is cast: those of ValidateLidarModel; kNonFinite, kInvalidInput and kUnknownName for
/// invalid objects and prints, more than 10000 objects, and a LiDAR inside an object.
Expected<SimulatedScan> SimulateScan(const Scene& scene, const LidarModel& model,
                                     const ScanOptions& options = {});

}  // namespace sextant
