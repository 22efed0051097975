// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <vector>

#include "geometry/point_cloud.h"
#include "io/problems/acfr_poses.h"
#include "simulator/scene/scene.h"

namespace sextant::test {

/// The placements of acfr/cam_lidar_calibration that have a scan.
inline constexpr int kAcfrScans[] = {2, 5, 9, 16, 20, 26, 30};

/// A point of a board in a scan.
struct BoardReturn {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double azimuth_rad = 0.0;
};

/// A board's points by ring, each ring in ascending azimuth.
using RingPoints = std::map<int, std::vector<BoardReturn>>;

/// The points on the board in a real scan. The recorded scans cover 363 degrees: if both ends lie
/// on the board, the second pass over it is left out.
RingPoints FirstPass(const PointCloud& board);

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double rms_m = 0.0;
};

/// Least-squares plane, refitted eight times to the points within 5 cm of it.
Plane FitPlane(const RingPoints& board);

/// The placement as a scene in the LiDAR frame: the board of 610 x 850 mm with its checkerboard at
/// the pose given by the stored corners, and walls of a room 6 m away behind it.
Scene AcfrScene(const AcfrPose& pose);

}  // namespace sextant::test
