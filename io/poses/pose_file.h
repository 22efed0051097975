// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// Which way a transform between a LiDAR and a camera maps points.
enum class PoseDirection { kCamFromLidar, kLidarFromCam };

/// "cam_from_lidar" or "lidar_from_cam".
std::string_view ToString(PoseDirection direction);

/// A transform between a LiDAR and a camera as a file states it.
struct StatedPose {
  Rigid3d transform;
  std::optional<PoseDirection> direction{};  ///< None: neither names nor axes show it.
  std::string basis{};         ///< What the direction follows from; a phrase for people.
  std::string camera_frame{};  ///< Empty: the file has no names.
  std::string lidar_frame{};
  /// Why the camera's frame may not be the optical one; refused unless the user states a direction.
  std::string doubt{};
  bool is_result = false;  ///< ReadCalibrationResult reads this file.
};

/// Reads a pose from any of these, recognised by the content:
/// - result.yaml of sextant calibrate or its JSON, JSON of sextant solve (its first answer), and
///   any YAML or JSON with the key cam_from_lidar or lidar_from_cam (also as OpenCV's matrix);
/// - truth.yaml of sextant simulate; truth.yaml:left chooses the camera of several;
/// - geometry_msgs/TransformStamped as YAML, alone or as the list `transforms` of a TFMessage;
/// - static transforms of ROS 1 (.launch) and ROS 2 (.launch.py, YAML), joints of a URDF;
/// - KITTI's calibration: Tr_velo_to_cam or Tr, rotated by R0_rect and moved by the fourth column
///   of the camera's projection; calib.txt:P2 chooses the camera. R and T of calib_velo_to_cam.txt;
/// - a 4x4 or 3x4 matrix in rows (rts.txt:2 is the second of several), or the seven numbers
///   x y z qx qy qz qw. A comment `# x y z qw qx qy qz` states the other order; without a comment
///   the numbers are refused where the camera would be upright with the other order, too;
/// - `extrinsics` with translation and rotation (a quaternion w x y z), as JSON.
/// Several transforms of ROS are connected from the only LiDAR to the only camera, by their names.
/// A frame of the camera whose name is not that of an optical frame is doubted where the camera is
/// not upright with it. Statements of one file that contradict each other by more than 0.001 (rad
/// or m) are an error. The direction follows from a key, from the names of frames or from the
/// format. Where a file has only numbers, it is the one in which the camera is upright (its y axis
/// along -z of the LiDAR), if the other is not. Errors: kIo; kParse with file and line; kNonFinite;
/// kMissingData where no such pose is found; kInvalidOption where the file must be made
/// unambiguous. Time is that of ParseYaml and O(n log n) in the frames, memory that of ParseYaml
/// and 1 KiB for each frame; XML is read up to 1 MiB.
Expected<StatedPose> ReadPoseFile(const std::filesystem::path& path);

/// The text of such a file, and the name that follows its path behind a colon; empty if none does.
struct PoseText {
  std::string file{};  ///< Without the name.
  std::string name{};
  std::string text{};
};
Expected<PoseText> ReadPoseText(const std::filesystem::path& path);

/// `name` chooses the camera of a KITTI file or of truth.yaml, or the number of a matrix from 1;
/// empty: the only one.
Expected<StatedPose> ParsePose(std::string_view text, const std::string& file,
                               std::string_view name = {});

/// cam_from_lidar of a pose. `asked` is the direction that the user states; it may not contradict
/// the file. Errors: kInvalidOption, also where neither states a direction; with the file's name.
Expected<Rigid3d> CamFromLidar(const StatedPose& pose, std::optional<PoseDirection> asked,
                               const std::string& file);

/// What is improbable of a pose, one sentence each: more than 20 m between the sensors; an optical
/// axis along the z axis of the LiDAR, unless it is a result of calibrate.
std::vector<std::string> DoubtsOf(const StatedPose& pose, const Rigid3d& cam_from_lidar);

/// A sentence where the camera is upright only with `transform` in the other direction than
/// `read_as`; none otherwise.
std::optional<std::string> DoubtOfDirection(const Rigid3d& transform, PoseDirection read_as);

}  // namespace sextant
