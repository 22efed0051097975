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

/// The board as one sensor saw it, as stored; metres in the sensor's frame.
struct AcfrBoardView {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, 4> corners_m{};  ///< Round the board; see ProblemFromAcfrPoses.
};

/// One placement of the board.
struct AcfrPose {
  int id = 0;
  AcfrBoardView in_cam;
  AcfrBoardView in_lidar;
  std::array<double, 4> angles_deg{};  ///< Between the edges of the board in the LiDAR's view.
  std::array<double, 2> widths_m{};
  std::array<double, 2> heights_m{};
  double distance_m = 0.0;
  double m_per_px = 0.0;
};

/// `poses.csv` of acfr/cam_lidar_calibration: 19 lines of three numbers a pose, lengths in mm.
/// Errors: kIo, kParse, kNonFinite, with file, line and field.
Expected<std::vector<AcfrPose>> ReadAcfrPoses(const std::filesystem::path& path);
Expected<std::vector<AcfrPose>> ParseAcfrPoses(std::string_view text, const std::string& file);

enum class AcfrPoints { kCorners, kCornersAndCentres };

/// The numbers (AcfrPose::id) of poses whose corners the file lists in another order, camera
/// against LiDAR, than it does in most poses: their labels were given otherwise, and whoever takes
/// the file's order pairs wrong corners. In the order of the list. Errors: those of
/// ResolveCornerOrders.
Expected<std::vector<int>> RelabelledAcfrPoses(std::span<const AcfrPose> poses);

/// Number of the board's centre among its "corners".
inline constexpr int kAcfrCentre = 4;

/// The corners as 3D-3D pairs: view is the pose's place in the list, board 0, corners numbered as
/// Board says. The file orders the corners differently in each sensor and from pose to pose: the
/// orders are solved (ResolveCornerOrders), not taken. Centres, where asked for, are corner
/// kAcfrCentre; they are no independent measurements.
/// Errors: those of ResolveCornerOrders.
Expected<CalibrationProblem> ProblemFromAcfrPoses(std::span<const AcfrPose> poses,
                                                  AcfrPoints points = AcfrPoints::kCorners);

}  // namespace sextant
