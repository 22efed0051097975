// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <map>
#include <set>

#include "geometry/coordinate_range.h"
#include "io/poses/pose_parts.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

bool HasAny(const std::string& name, std::initializer_list<std::string_view> words) {
  std::string lower = name;
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::any_of(
      words, [&](std::string_view word) { return lower.find(word) != std::string::npos; });
}

bool NamesCamera(const std::string& name) {
  return HasAny(name, {"cam", "optical", "image", "rgb", "color", "colour"});
}

bool NamesLidar(const std::string& name) {
  return HasAny(name, {"lidar", "laser", "velo", "ouster", "os_sensor", "os0", "os1", "os2",
                       "livox", "hesai", "pandar", "rslidar", "robosense", "vlp", "hdl", "scan"});
}

// The only name with the property; of several cameras the only optical frame. Empty if none is.
std::string OnlyOne(const std::set<std::string>& names, bool (*is)(const std::string&)) {
  std::vector<std::string> found;
  std::ranges::copy_if(names, std::back_inserter(found), is);
  if (found.size() > 1 && is == NamesCamera) {
    std::erase_if(found, [](const std::string& name) { return !HasAny(name, {"optical"}); });
  }
  return found.size() == 1 ? found.front() : std::string();
}

// The pose of every frame that is connected with `from`, in it.
std::map<std::string, Rigid3d> PosesIn(const std::string& from,
                                       const std::vector<FrameTransform>& transforms) {
  std::map<std::string, Rigid3d> poses = {{from, Rigid3d{}}};
  for (bool grew = true; grew;) {
    grew = false;
    for (const FrameTransform& t : transforms) {
      const auto parent = poses.find(t.parent);
      const auto child = poses.find(t.child);
      if ((parent == poses.end()) == (child == poses.end())) continue;
      grew = true;
      if (child == poses.end()) {
        poses.emplace(t.child, parent->second * t.parent_from_child);
      } else {
        poses.emplace(t.parent, child->second * t.parent_from_child.Inverse());
      }
    }
  }
  return poses;
}

StatedPose OfSingle(const FrameTransform& t, const std::string& camera, const std::string& lidar) {
  StatedPose pose{
      .transform = t.parent_from_child,
      .basis = fmt::format("it is the pose of {} in {}", Quoted(t.child), Quoted(t.parent))};
  const bool camera_is_parent = t.parent == camera;
  const bool known = !camera.empty() && (lidar.empty() || lidar != camera) &&
                     (lidar == (camera_is_parent ? t.child : t.parent));
  if (!known) {
    pose.basis += ", and these names do not say which is the LiDAR and which the camera";
    return pose;
  }
  pose.direction = camera_is_parent ? PoseDirection::kCamFromLidar : PoseDirection::kLidarFromCam;
  pose.camera_frame = camera;
  pose.lidar_frame = lidar;
  return pose;
}

}  // namespace

Expected<StatedPose> ConnectFrames(const std::vector<FrameTransform>& transforms,
                                   const std::string& optical_frame, const std::string& file) {
  std::set<std::string> names;
  for (const FrameTransform& t : transforms) names.insert({t.parent, t.child});
  const bool is_marked = names.contains(optical_frame);
  const std::string camera = is_marked ? optical_frame : OnlyOne(names, NamesCamera);
  std::string lidar = OnlyOne(names, NamesLidar);
  if (transforms.size() == 1) {
    // Where the file names the camera, the other frame is the LiDAR, whatever its name.
    const FrameTransform& only = transforms.front();
    if (is_marked) lidar = only.parent == camera ? only.child : only.parent;
    return OfSingle(only, camera, lidar);
  }
  const std::map<std::string, Rigid3d> in_camera = PosesIn(camera, transforms);
  const auto found = in_camera.find(lidar);
  if (camera.empty() || lidar.empty() || camera == lidar || found == in_camera.end()) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("{}: expected the transform of one LiDAR and one camera, by the "
                                 "names of their frames, or a single transform; its frames are {}",
                                 file, fmt::join(names, ", ")));
  }
  return StatedPose{
      .transform = found->second,
      .direction = PoseDirection::kCamFromLidar,
      .basis = fmt::format("its frames {} and {} are connected", Quoted(camera), Quoted(lidar)),
      .camera_frame = camera,
      .lidar_frame = lidar};
}

std::string OpticalFrameIn(std::string_view text) {
  constexpr std::string_view kAfter = " is the camera's optical frame";
  const std::size_t end = text.find(kAfter);
  if (end == std::string_view::npos) return {};
  const std::size_t begin = text.find_last_of(" \t\n#", end - 1) + 1;
  return std::string(text.substr(begin, end - begin));
}

void RecogniseByAxes(StatedPose& pose) {
  // Row y, column z: the part of the LiDAR's z axis along the camera's y axis.
  const Eigen::Matrix3d rotation = pose.transform.rotation.toRotationMatrix();
  const double as_stated = rotation(1, 2);
  const double inverted = rotation(2, 1);
  constexpr double kUpright = 0.7;
  if (as_stated < -kUpright && std::abs(inverted) < kUpright) {
    pose.direction = PoseDirection::kCamFromLidar;
  } else if (inverted < -kUpright && std::abs(as_stated) < kUpright) {
    pose.direction = PoseDirection::kLidarFromCam;
  }
  pose.basis = pose.direction ? "the only direction in which the camera is upright"
                              : "the file has numbers alone";
}

Expected<Rigid3d> PoseOfNumbers(const std::array<double, 3>& translation,
                                const std::array<double, 4>& wxyz, const std::string& file,
                                int line) {
  const Eigen::Quaterniond rotation(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!(std::abs(rotation.norm() - 1.0) < 1e-3)) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: expected a quaternion of length 1, got {:g}",
                                 ToString(Place{.file = file, .line = line}), rotation.norm()));
  }
  const Eigen::Vector3d moved(translation[0], translation[1], translation[2]);
  if (!(moved.cwiseAbs().maxCoeff() <= kMaxCoordinate_m)) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: expected a translation of at most {:g} m",
                                 ToString(Place{.file = file, .line = line}), kMaxCoordinate_m));
  }
  return Rigid3d{rotation.normalized(), moved};
}

}  // namespace sextant
