// SPDX-License-Identifier: Apache-2.0
#include "io/poses/pose_file.h"

#include <fmt/core.h>

#include <system_error>

#include "io/poses/pose_parts.h"
#include "io/text/line_reader.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

// A line "Tr: 1 2 3" or "R: 1 2 3" is KITTI's.
bool IsKitti(std::string_view text, const std::string& file) {
  LineReader in(file, text);
  while (in.Next()) {
    const std::string_view first = in.Field(0);
    const bool is_key = first == "Tr:" || first == "R:" || first.starts_with("Tr_velo");
    if (is_key && in.field_count() > 9) return true;
  }
  return false;
}

// The truth of a simulated session begins with this key.
bool IsTruth(std::string_view text, const std::string& file) {
  LineReader in(file, text);
  return in.Next() && in.Field(0) == "sextant_truth:";
}

bool BeginsWithNumber(std::string_view text, const std::string& file) {
  LineReader in(file, text);
  return in.Next() && ParseFinite(in.Field(0), {}).has_value();
}

bool IsXml(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return first != std::string_view::npos && text[first] == '<';
}

}  // namespace

std::string_view ToString(PoseDirection direction) {
  return direction == PoseDirection::kCamFromLidar ? "cam_from_lidar" : "lidar_from_cam";
}

Expected<PoseText> ReadPoseText(const std::filesystem::path& path) {
  PoseText pose{.file = path.string()};
  const std::size_t colon = pose.file.rfind(':');
  std::error_code ignored;
  if (colon != std::string::npos && !std::filesystem::exists(path, ignored)) {
    pose.name = pose.file.substr(colon + 1);
    pose.file.resize(colon);
  }
  SEXTANT_ASSIGN_OR_RETURN(pose.text, ReadTextFile(pose.file));
  return pose;
}

Expected<StatedPose> ReadPoseFile(const std::filesystem::path& path) {
  SEXTANT_ASSIGN_OR_RETURN(const PoseText pose, ReadPoseText(path));
  return ParsePose(pose.text, pose.file, pose.name);
}

Expected<StatedPose> ParsePose(std::string_view text, const std::string& file,
                               std::string_view name) {
  if (IsKitti(text, file)) return ParsePoseKitti(text, file, name);
  if (!IsXml(text) && BeginsWithNumber(text, file)) return ParsePoseNumbers(text, file, name);
  if (IsTruth(text, file)) return ParsePoseTruth(text, file, name);
  if (!name.empty()) {
    return MakeError(
        ErrorCode::kParse,
        fmt::format("{}: has nothing named {}; only a camera of KITTI's calibration or of "
                    "truth.yaml, and a matrix of several, can be chosen",
                    file, Quoted(name)));
  }
  if (IsXml(text)) return ParsePoseXml(text, file);
  if (text.find("static_transform_publisher") != std::string_view::npos &&
      text.find("LaunchDescription") != std::string_view::npos) {
    return ParsePoseLaunch(text, file);
  }
  return ParsePoseYaml(text, file);
}

Expected<Rigid3d> CamFromLidar(const StatedPose& pose, std::optional<PoseDirection> asked,
                               const std::string& file) {
  if (!asked && !pose.direction) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("{}: whether this is cam_from_lidar (it maps points of the LiDAR "
                                 "into the camera's optical frame) or its inverse cannot be seen "
                                 "from it{}; add --pose-is cam_from_lidar or lidar_from_cam",
                                 file, pose.basis.empty() ? "" : ": " + pose.basis));
  }
  if (!asked && !pose.doubt.empty()) {
    return MakeError(ErrorCode::kInvalidOption, file + ": " + pose.doubt);
  }
  // Axes are evidence, names and keys are statements.
  const bool is_stated = pose.direction && !pose.camera_frame.empty();
  if (asked && is_stated && *asked != *pose.direction) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("--pose-is {} contradicts {}, which holds {}: {}",
                                 ToString(*asked), file, ToString(*pose.direction), pose.basis));
  }
  const PoseDirection direction = asked ? *asked : *pose.direction;
  return direction == PoseDirection::kCamFromLidar ? pose.transform : pose.transform.Inverse();
}

std::vector<std::string> DoubtsOf(const StatedPose& pose, const Rigid3d& cam_from_lidar) {
  constexpr double kMaxApart_m = 20.0;
  constexpr double kAlong = 0.866;  // Within 30 deg.
  std::vector<std::string> doubts;
  const double apart_m = cam_from_lidar.translation.norm();
  if (apart_m > kMaxApart_m) {
    doubts.push_back(
        fmt::format("the sensors are {:.0f} m apart; is the translation in millimetres? "
                    "Expected metres",
                    apart_m));
  }
  const double along_up = (cam_from_lidar.rotation * Eigen::Vector3d::UnitZ()).z();
  if (along_up > kAlong && !pose.is_result) {
    doubts.push_back(
        fmt::format("the optical axis of {} is along the LiDAR's z axis, which mostly points up; "
                    "the optical frame has x right, y down, z forward",
                    pose.camera_frame.empty() ? "the camera" : pose.camera_frame));
  }
  return doubts;
}

std::optional<std::string> DoubtOfDirection(const Rigid3d& transform, PoseDirection read_as) {
  StatedPose by_axes{.transform = transform};
  RecogniseByAxes(by_axes);
  if (!by_axes.direction || *by_axes.direction == read_as) return std::nullopt;
  return fmt::format(
      "read as {}, the camera is not upright; read as {}, it would be (--pose-is {})",
      ToString(read_as), ToString(*by_axes.direction), ToString(*by_axes.direction));
}

}  // namespace sextant
