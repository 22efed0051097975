// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "base/error.h"
#include "geometry/point_cloud.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/scene/scene.h"

namespace sextant {

enum class SceneObject : std::uint8_t { kBoard, kWall, kBox, kCylinder };

/// What a point really is.
struct PointTruth {
  SceneObject object = SceneObject::kBoard;
  int index = 0;          ///< Into the scene's list of such objects.
  double spot_share = 1;  ///< Of the beam's spot, what is on that face of it; 1: no edge in it.
  bool mixed = false;     ///< Its range lies between that face's and another's.
};

struct ScanOptions {
  std::uint64_t seed = 1;     ///< Also of what is constant for the unit: its rings' biases.
  int scan_index = 0;         ///< Scans of one seed differ by it.
  double start_time_s = 0.0;  ///< After the session's start: where swinging boards are.
  bool noise = true;          ///< Of range, biases, start azimuth.
  bool quantisation = true;   ///< Of range and intensity.
  bool divergence = true;     ///< Off: a beam is a line, and there are no mixed points.
  bool dropouts = true;       ///< Random and for weakness.
  bool truth = false;         ///< Fill SimulatedScan::truth.
};

struct SimulatedScan {
  PointCloud cloud;               ///< Column by column; `ring` is empty for a rosette.
  std::vector<PointTruth> truth;  ///< One a point, where asked for.
};

/// One turn of `model` at scene.lidar.world_from_lidar. (scene.lidar.model is not looked at.)
///
/// Every beam leaves at its own time, so that swinging boards smear. A spot within one surface
/// gives its central ray's range, exactly on the surface where noise and quantisation are off. A
/// spot across an edge is cut into sub-rays of equal power; a surface's echo is the sum of
/// reflectivity cos(incidence) / range^2 over its sub-rays, echoes nearer than a pulse length merge
/// to their power-weighted mean, and the strongest echo is returned, along the central ray. So
/// edges look up to half a spot too wide where there is nothing bright behind them.
///
/// The same scene, model and options give the same bits, whatever the number of threads.
/// Errors, before any beam is cast: those of ValidateLidarModel; kNonFinite, kInvalidInput and
/// kUnknownName for objects and prints that cannot be, too many objects (10000), a LiDAR inside
/// one.
Expected<SimulatedScan> SimulateScan(const Scene& scene, const LidarModel& model,
                                     const ScanOptions& options = {});

}  // namespace sextant
