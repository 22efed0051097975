// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// The board as seen by one sensor, in the order of the file; metres in the sensor's frame.
struct AcfrBoardView {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, 4> corners_m{};  ///< Around the board; see ProblemFromAcfrPoses.
};

/// One placement of the board.
struct AcfrPose {
  int id = 0;
  AcfrBoardView in_cam;
  AcfrBoardView in_lidar;
  std::array<double, 4> angles_deg{};  ///< Between the edges of the board as measured by the LiDAR.
  std::array<double, 2> widths_m{};
  std::array<double, 2> heights_m{};
  double distance_m = 0.0;
  double m_per_px = 0.0;
};

/// Reads `poses.csv` of acfr/cam_lidar_calibration: 19 lines of three numbers per pose, lengths in
/// mm.
/// Errors: kIo, kParse, kNonFinite, with file, line and field.
/// Time is linear in the file's size, memory at most 20 times it.
Expected<std::vector<AcfrPose>> ReadAcfrPoses(const std::filesystem::path& path);
Expected<std::vector<AcfrPose>> ParseAcfrPoses(std::string_view text, const std::string& file);

enum class AcfrPoints { kCorners, kCornersAndCentres };

/// The numbers (AcfrPose::id), in the order of `poses`, of those poses for which the order of the
/// camera's corners relative to the LiDAR's differs from that of most poses: pairing them in the
/// file's order would give wrong pairs. Errors: those of ResolveCornerOrders.
Expected<std::vector<int>> RelabelledAcfrPoses(std::span<const AcfrPose> poses);

/// The corner number that stands for the board's centre.
inline constexpr int kAcfrCentre = 4;

/// The corners as 3D-3D pairs: the view is the index of the pose, the board 0, and the corners are
/// numbered as in Board. The file's order of corners differs between the sensors and between poses;
/// ResolveCornerOrders therefore estimates it. Centres, if requested, have the corner number
/// kAcfrCentre; they are not independent measurements.
/// Errors: those of ResolveCornerOrders.
Expected<CalibrationProblem> ProblemFromAcfrPoses(std::span<const AcfrPose> poses,
                                                  AcfrPoints points = AcfrPoints::kCorners);

}  // namespace sextant
