// SPDX-License-Identifier: Apache-2.0
#include "cli/pose_argument.h"

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "base/units.h"
#include "geometry/coordinate_range.h"
#include "geometry/so3.h"
#include "io/export/export_rig.h"
#include "io/output/standard_output.h"
#include "io/text/number_text.h"
#include "io/text/text_file.h"

namespace sextant::cli {
namespace {

Expected<Rigid3d> PoseFromNumbers(const std::string& option,
                                  const std::vector<std::string>& texts) {
  constexpr std::size_t kNumbers = 7;
  double values[kNumbers] = {};
  if (texts.size() != kNumbers) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("{}: expected a file, or X Y Z QW QX QY QZ; got {} values", option,
                                 texts.size()));
  }
  for (std::size_t i = 0; i < kNumbers; ++i) {
    SEXTANT_ASSIGN_OR_RETURN(const double value, ParseFinite(texts[i], {.file = option}));
    values[i] = value;
  }
  const Eigen::Quaterniond rotation(values[3], values[4], values[5], values[6]);
  if (std::abs(rotation.norm() - 1.0) > 0.01) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("{}: expected a quaternion of length 1, got {:.3f}", option, rotation.norm()));
  }
  const Eigen::Vector3d translation(values[0], values[1], values[2]);
  if (translation.cwiseAbs().maxCoeff() > kMaxCoordinate_m) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("{}: expected a translation of at most {:g} m", option, kMaxCoordinate_m));
  }
  return Rigid3d{rotation.normalized(), translation};
}

std::optional<PoseDirection> AskedDirection(const std::string& pose_is) {
  if (pose_is.empty()) return std::nullopt;
  return pose_is == ToString(PoseDirection::kCamFromLidar) ? PoseDirection::kCamFromLidar
                                                           : PoseDirection::kLidarFromCam;
}

PoseDirection OtherThan(PoseDirection direction) {
  return direction == PoseDirection::kCamFromLidar ? PoseDirection::kLidarFromCam
                                                   : PoseDirection::kCamFromLidar;
}

// For a direction that no file states: it is the user's, or the default.
void WarnOfAxes(const std::string& source, const Rigid3d& transform, PoseDirection read_as) {
  if (const auto doubt = DoubtOfDirection(transform, read_as)) {
    PrintError("warning: {}: {}\n", source, *doubt);
  }
}

bool IsUpright(const Rigid3d& cam_from_lidar) {
  return (cam_from_lidar.rotation * Eigen::Vector3d::UnitZ()).y() < -0.7;
}

// Numbers in the order of ROS, x y z w, are the likely mistake.
void WarnOfNumbers(const std::string& option, const Rigid3d& pose, const std::string& pose_is) {
  const bool is_inverse = AskedDirection(pose_is) == PoseDirection::kLidarFromCam;
  const auto cam_from_lidar = [&](const Rigid3d& stated) {
    return is_inverse ? stated.Inverse() : stated;
  };
  for (const std::string& doubt : DoubtsOf({}, cam_from_lidar(pose))) {
    PrintError("warning: {}: {}\n", option, doubt);
  }
  WarnOfAxes(option, pose,
             is_inverse ? PoseDirection::kLidarFromCam : PoseDirection::kCamFromLidar);
  const Eigen::Quaterniond& q = pose.rotation;
  const Rigid3d other{Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()), pose.translation};
  if (!IsUpright(cam_from_lidar(pose)) && IsUpright(cam_from_lidar(other))) {
    PrintError(
        "warning: {}: the camera would be upright with the quaternion read as x y z w; the order "
        "of this option is w x y z\n",
        option);
  }
}

Expected<Rigid3d> CamFromLidarWithNote(const StatedPose& pose, const std::string& pose_is,
                                       const std::string& path) {
  const std::optional<PoseDirection> asked = AskedDirection(pose_is);
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d cam_from_lidar, CamFromLidar(pose, asked, path));
  for (const std::string& doubt : DoubtsOf(pose, cam_from_lidar)) {
    PrintError("warning: {}: {}\n", path, doubt);
  }
  if (asked && pose.camera_frame.empty()) WarnOfAxes(path, pose.transform, *asked);
  if (!asked && pose.camera_frame.empty()) {
    PrintError("{}: read as {}: {}. If it is not, add --pose-is\n", path, ToString(*pose.direction),
               pose.basis);
  }
  return cam_from_lidar;
}

// The named sensor, or the only camera (or LiDAR) of the rig.
Expected<std::string> ChosenSensor(const RigResult& rig, const std::string& name, bool camera) {
  if (!name.empty()) return name;
  std::vector<std::string> found;
  std::string all;
  for (const RigResultSensor& sensor : rig.sensors) {
    all += (all.empty() ? "" : ", ") + sensor.name;
    if (sensor.camera.has_value() == camera) found.push_back(sensor.name);
  }
  if (found.size() == 1) return found.front();
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("the result of a rig with {} {}: choose one with {}; there are: {}",
                               found.empty() ? "no" : "several",
                               camera ? "sensors with intrinsics" : "sensors without intrinsics",
                               camera ? "--camera-name" : "--lidar-name", all));
}

// The pose of two sensors as the statement of a file that leaves no doubt of its direction.
Expected<GivenPose> PairOfRig(const PoseText& text, const std::string& path,
                              const std::string& pose_is, const PairNames& names) {
  SEXTANT_ASSIGN_OR_RETURN(const RigResult rig, ParseRigResult(text.text, path));
  SEXTANT_ASSIGN_OR_RETURN(const std::string camera, ChosenSensor(rig, names.camera, true));
  SEXTANT_ASSIGN_OR_RETURN(const std::string lidar, ChosenSensor(rig, names.lidar, false));
  GivenPose given{.basis = "the result of sextant rig states it"};
  SEXTANT_ASSIGN_OR_RETURN(given.result, ResultOfPair(rig, camera, lidar));
  const StatedPose stated{.transform = given.result.cam_from_lidar,
                          .direction = given.direction,
                          .basis = given.basis,
                          .camera_frame = camera,
                          .lidar_frame = lidar,
                          .is_result = true};
  SEXTANT_ASSIGN_OR_RETURN(given.result.cam_from_lidar,
                           CamFromLidarWithNote(stated, pose_is, path));
  return given;
}

template <class T>
Expected<T> InFile(Expected<T> value, const std::string& path) {
  if (!value && !value.error().message.starts_with(path)) {
    value.error().message.insert(0, path + ": ");
  }
  return value;
}

Expected<GivenPose> GivenPoseOfText(const PoseText& text, const std::string& path,
                                    const std::string& pose_is, const PairNames& names) {
  if (IsRigResult(text.text)) return InFile(PairOfRig(text, path, pose_is, names), path);
  if (!names.camera.empty() || !names.lidar.empty()) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("--camera-name and --lidar-name choose sensors of rig.json, the "
                                 "result of sextant rig, which {} is not: leave them out",
                                 path));
  }
  SEXTANT_ASSIGN_OR_RETURN(const StatedPose pose, ParsePose(text.text, text.file, text.name));
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d cam_from_lidar, CamFromLidarWithNote(pose, pose_is, path));
  GivenPose given{.direction = pose_is.empty() ? *pose.direction : *AskedDirection(pose_is),
                  .basis = pose_is.empty() ? pose.basis : "stated by --pose-is"};
  if (pose.is_result) {
    SEXTANT_ASSIGN_OR_RETURN(given.result, ParseCalibrationResult(text.text, path));
    return given;
  }
  given.result.cam_from_lidar = cam_from_lidar;
  if (!pose.camera_frame.empty()) given.result.camera_frame = pose.camera_frame;
  if (!pose.lidar_frame.empty()) given.result.lidar_frame = pose.lidar_frame;
  return given;
}

}  // namespace

void DeclarePoseIs(std::string& pose_is, Arguments& arguments, const std::string& of) {
  arguments.Add("--pose-is", pose_is,
                "Direction of a pose whose file does not state it: cam_from_lidar maps points of\n"
                "the LiDAR into the camera's optical frame",
                {.choices = {"cam_from_lidar", "lidar_from_cam"}, .needs = of});
}

void DeclarePairNames(PairNames& names, Arguments& arguments) {
  arguments.Add("--camera-name", names.camera,
                "For rig.json of sextant rig: the camera, by its name; default: the only one");
  arguments.Add("--lidar-name", names.lidar,
                "For rig.json: the sensor that the scan is of; default: the only LiDAR");
}

Expected<Rigid3d> PoseOfFile(const std::string& path, const std::string& pose_is) {
  SEXTANT_ASSIGN_OR_RETURN(const StatedPose pose, ReadPoseFile(path));
  return CamFromLidarWithNote(pose, pose_is, path);
}

Expected<Rigid3d> PoseFromArgument(const std::string& option,
                                   const std::vector<std::string>& values,
                                   const std::string& pose_is) {
  if (values.size() == 1) {
    Expected<Rigid3d> pose = PoseOfFile(values.front(), pose_is);
    // Numbers in quotes are one value, too.
    if (!pose && pose.error().code == ErrorCode::kIo) {
      pose.error().message = fmt::format(
          "{}: {}; expected a file with a pose, or seven separate numbers X Y Z QW QX QY QZ, "
          "without quotes",
          option, pose.error().message);
    }
    return pose;
  }
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose, PoseFromNumbers(option, values));
  WarnOfNumbers(option, pose, pose_is);
  return AskedDirection(pose_is) == PoseDirection::kLidarFromCam ? pose.Inverse() : pose;
}

void WarnOfDirection(const std::string& option, const std::vector<std::string>& values,
                     const std::string& pose_is, const Rigid3d& given, const Rigid3d& answer) {
  constexpr double kFar_rad = 45.0 * kRadPerDeg;
  constexpr double kNear_rad = 15.0 * kRadPerDeg;
  const double apart_rad = RotationDistance(given.rotation, answer.rotation);
  const double inverse_rad = RotationDistance(given.rotation.conjugate(), answer.rotation);
  if (apart_rad < kFar_rad || inverse_rad > kNear_rad) return;
  // What a file states is not known here.
  const bool is_known = !pose_is.empty() || values.size() != 1;
  const PoseDirection read_as = AskedDirection(pose_is).value_or(PoseDirection::kCamFromLidar);
  PrintError(
      "warning: {}: the pose is {:.0f} deg from the answer, but its inverse {:.0f} deg; it "
      "seems to be {}\n",
      option, apart_rad * kDegPerRad, inverse_rad * kDegPerRad,
      is_known ? fmt::format("{0} (--pose-is {0})", ToString(OtherThan(read_as)))
               : "of the other direction than its file states");
}

Expected<GivenPose> GivenPoseOfFile(const std::string& path, const std::string& pose_is,
                                    const PairNames& names) {
  SEXTANT_ASSIGN_OR_RETURN(const PoseText text, ReadPoseText(path));
  return GivenPoseOfText(text, path, pose_is, names);
}

Expected<CalibrationResult> ResultOfText(const PoseText& text, const std::string& path,
                                         const std::string& pose_is, const PairNames& names) {
  SEXTANT_ASSIGN_OR_RETURN(GivenPose given, GivenPoseOfText(text, path, pose_is, names));
  return std::move(given.result);
}

Expected<CalibrationResult> ResultOfFile(const std::string& path, const std::string& pose_is,
                                         const PairNames& names) {
  SEXTANT_ASSIGN_OR_RETURN(const PoseText text, ReadPoseText(path));
  return ResultOfText(text, path, pose_is, names);
}

Expected<RigResult> RigOfFile(const std::string& path, const std::string& option) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path));
  if (IsRigResult(text)) return ParseRigResult(text, path);
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("{}: expected rig.json, the result of sextant rig, which {} is not",
                               option, path));
}

}  // namespace sextant::cli
