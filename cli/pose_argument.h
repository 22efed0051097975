// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "cli/command.h"
#include "geometry/rigid3d.h"
#include "io/poses/pose_file.h"
#include "io/results/calibration_result.h"

namespace sextant::cli {

/// Help on the files that are read as a pose.
inline constexpr const char* kPoseHelp =
    "result.yaml, a 4x4 matrix, KITTI's calib.txt, a TransformStamped (YAML), a static transform\n"
    "of ROS 1 or 2, a URDF, x y z qx qy qz qw, or JSON; recognised by its content";

/// --pose-is: the direction of poses whose file does not state it.
void DeclarePoseIs(std::string& pose_is, Arguments& arguments);

/// cam_from_lidar of a file. Where the direction follows from the axes alone, a line on standard
/// error says so. Errors: those of ReadPoseFile and CamFromLidar.
Expected<Rigid3d> PoseOfFile(const std::string& path, const std::string& pose_is);

/// A pose given as an option: a file for PoseOfFile, or the seven values X Y Z QW QX QY QZ of
/// cam_from_lidar, or of what --pose-is states.
/// Errors: kInvalidOption, with the option's name; those of PoseOfFile.
Expected<Rigid3d> PoseFromArgument(const std::string& option,
                                   const std::vector<std::string>& values,
                                   const std::string& pose_is);

/// A pose as a file states it, and the direction in which it was read: as --pose-is states, or as
/// follows from the file.
struct GivenPose {
  CalibrationResult result{};
  PoseDirection direction = PoseDirection::kCamFromLidar;
  std::string basis{};  ///< What the direction follows from; a phrase for people.
};

/// As ResultOfFile, with the direction.
Expected<GivenPose> GivenPoseOfFile(const std::string& path, const std::string& pose_is);

/// The result in a file of sextant calibrate; of any other file a result with its pose and the
/// names of its frames alone. Errors: those of ReadCalibrationResult and PoseOfFile.
Expected<CalibrationResult> ResultOfFile(const std::string& path, const std::string& pose_is);
/// The same of its text, which ReadPoseText has read from `path`.
Expected<CalibrationResult> ResultOfText(const PoseText& text, const std::string& path,
                                         const std::string& pose_is);

}  // namespace sextant::cli
