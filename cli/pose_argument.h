// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "cli/command.h"
#include "geometry/rigid3d.h"
#include "io/poses/pose_file.h"
#include "io/results/calibration_result.h"
#include "io/results/rig_result.h"

namespace sextant::cli {

/// Help on the files that are read as a pose.
inline constexpr const char* kPoseHelp =
    "result.yaml, truth.yaml (truth.yaml:CAMERA of several), a 4x4 matrix, KITTI's calib.txt, a\n"
    "TransformStamped (YAML), a static transform of ROS 1 or 2, a URDF, x y z qx qy qz qw, or\n"
    "JSON; recognised by its content";

/// --pose-is: the direction of poses whose file does not state it. `of`: the option that gives the
/// poses; empty: a required argument does.
void DeclarePoseIs(std::string& pose_is, Arguments& arguments, const std::string& of = "");

/// cam_from_lidar of a file. Where the direction follows from the axes alone, a line on standard
/// error says so. Errors: those of ReadPoseFile and CamFromLidar.
Expected<Rigid3d> PoseOfFile(const std::string& path, const std::string& pose_is);

/// A pose given as an option: a file for PoseOfFile, or the seven values X Y Z QW QX QY QZ of
/// cam_from_lidar, or of what --pose-is states.
/// Errors: kInvalidOption, with the option's name; those of PoseOfFile, and where there is no such
/// file, both forms.
Expected<Rigid3d> PoseFromArgument(const std::string& option,
                                   const std::vector<std::string>& values,
                                   const std::string& pose_is);

/// A warning on standard error where the inverse of a given pose has the rotation of an answer (to
/// 15 deg) and the pose itself is more than 45 deg off. `given`: what PoseFromArgument returned for
/// the other arguments.
void WarnOfDirection(const std::string& option, const std::vector<std::string>& values,
                     const std::string& pose_is, const Rigid3d& given, const Rigid3d& answer);

/// Two sensors of a rig; an empty name is not chosen.
struct PairNames {
  std::string camera{};
  std::string lidar{};
};

/// --camera-name and --lidar-name: which two sensors of a rig's result are meant.
void DeclarePairNames(PairNames& names, Arguments& arguments);

/// A pose as a file states it, and the direction in which it was read: as --pose-is states, or as
/// follows from the file.
struct GivenPose {
  CalibrationResult result{};
  PoseDirection direction = PoseDirection::kCamFromLidar;
  std::string basis{};  ///< What the direction follows from; a phrase for people.
};

/// As ResultOfFile, with the direction.
Expected<GivenPose> GivenPoseOfFile(const std::string& path, const std::string& pose_is,
                                    const PairNames& names = {});

/// The result in a file of sextant calibrate; of any other file a result with its pose and the
/// names of its frames alone. Of a rig's result the pose of the named sensors, whatever connects
/// them; a name may be empty where the rig has one sensor of that kind. Errors: those of
/// ReadCalibrationResult, PoseOfFile and ResultOfPair; kInvalidOption for names with another file,
/// and where a choice is missing, with the names to choose from.
Expected<CalibrationResult> ResultOfFile(const std::string& path, const std::string& pose_is,
                                         const PairNames& names = {});
/// The same of its text, which ReadPoseText has read from `path`.
Expected<CalibrationResult> ResultOfText(const PoseText& text, const std::string& path,
                                         const std::string& pose_is, const PairNames& names = {});

/// The rig's result in a file. Errors: kIo; those of ParseRigResult; kInvalidOption for any other
/// file, with the name of the option that needs one.
Expected<RigResult> RigOfFile(const std::string& path, const std::string& option);

}  // namespace sextant::cli
