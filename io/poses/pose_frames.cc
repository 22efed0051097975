// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <set>

#include "base/text/lower_case.h"
#include "geometry/coordinate_range.h"
#include "io/poses/pose_parts.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

bool HasAny(const std::string& name, std::initializer_list<std::string_view> words) {
  const std::string lower = LowerCase(name);
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

// A frame that is connected with the root of a tree, by the transform `by` of the frame `next`.
struct Connected {
  Rigid3d pose;
  std::string next{};
  const FrameTransform* by = nullptr;  // None: the root.
};
using Tree = std::map<std::string, Connected>;

// The pose of every frame that is connected with `from`, in it; by the fewest transforms, and of
// several between two frames by the first one.
Tree PosesIn(const std::string& from, const std::vector<FrameTransform>& transforms) {
  std::map<std::string, std::vector<const FrameTransform*>> at_frame;
  for (const FrameTransform& t : transforms) {
    at_frame[t.parent].push_back(&t);
    at_frame[t.child].push_back(&t);
  }
  Tree poses = {{from, Connected{}}};
  std::vector<std::string> reached = {from};
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const std::string frame = reached[i];
    const Rigid3d pose = poses.at(frame).pose;
    for (const FrameTransform* t : at_frame[frame]) {
      const bool is_parent = t->parent == frame;
      const std::string& other = is_parent ? t->child : t->parent;
      const Rigid3d frame_from_other =
          is_parent ? t->parent_from_child : t->parent_from_child.Inverse();
      const bool is_new = poses.emplace(other, Connected{pose * frame_from_other, frame, t}).second;
      if (is_new) reached.push_back(other);
    }
  }
  return poses;
}

// The transforms on the way from the root to a frame, and how many of them each frame of the tree
// has on its own way. Those it shares are the first ones.
struct Way {
  std::vector<const FrameTransform*> transforms{};
  std::map<std::string, std::size_t> shared{};
};

Way WayTo(const std::string& frame, const Tree& tree) {
  Way way;
  std::vector<std::string> frames;
  for (const std::string* at = &frame; tree.at(*at).by != nullptr; at = &tree.at(*at).next) {
    way.transforms.push_back(tree.at(*at).by);
    frames.push_back(*at);
  }
  std::ranges::reverse(way.transforms);
  std::ranges::reverse(frames);
  for (std::size_t i = 0; i < frames.size(); ++i) way.shared[frames[i]] = i + 1;
  // Every other frame shares what the frame before it does.
  for (const auto& [name, connected] : tree) {
    std::vector<const std::string*> unknown;
    const std::string* at = &name;
    while (!way.shared.contains(*at) && tree.at(*at).by != nullptr) {
      unknown.push_back(at);
      at = &tree.at(*at).next;
    }
    const std::size_t shared = way.shared[*at];
    for (const std::string* one : unknown) way.shared[*one] = shared;
  }
  return way;
}

// A transform beside the tree may not contradict one on the way to `frame`; what moves elsewhere
// (odometry, repeated over time) does not matter.
Expected<void> CheckContradictions(const Tree& tree, const std::vector<FrameTransform>& transforms,
                                   const std::string& frame, const std::string& file) {
  const Way way = WayTo(frame, tree);
  for (const FrameTransform& t : transforms) {
    const auto parent = tree.find(t.parent);
    const auto child = tree.find(t.child);
    if (parent == tree.end() || child == tree.end()) continue;
    const std::size_t first = std::min(way.shared.at(t.parent), way.shared.at(t.child));
    if (first == std::max(way.shared.at(t.parent), way.shared.at(t.child))) continue;
    if (Agree(parent->second.pose * t.parent_from_child, child->second.pose)) continue;
    const FrameTransform& on_way = *way.transforms[first];
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: the transform of {} and {} at line {} contradicts that of "
                                 "{} and {} at line {}; expected one of them",
                                 file, Quoted(t.parent), Quoted(t.child), t.line,
                                 Quoted(on_way.parent), Quoted(on_way.child), on_way.line));
  }
  return {};
}

// A frame that is not named an optical one is, by ROS's convention, x forward, y left, z up.
void DoubtOpticalFrame(StatedPose& pose) {
  if (!pose.direction || HasAny(pose.camera_frame, {"optical"})) return;
  const bool is_stated = *pose.direction == PoseDirection::kCamFromLidar;
  const Rigid3d cam_from_lidar = is_stated ? pose.transform : pose.transform.Inverse();
  const Eigen::Vector3d up_in_cam = cam_from_lidar.rotation * Eigen::Vector3d::UnitZ();
  if (up_in_cam.y() < kUprightCosine) return;
  const bool is_link = up_in_cam.z() > -kUprightCosine;
  pose.doubt = fmt::format(
      "{} {}; add the transform from it to its optical frame, whose name has \"optical\" (rpy "
      "-1.5708 0 -1.5708 where x is forward), or add --pose-is {} if it is the optical frame",
      pose.camera_frame,
      is_link ? "has x forward by ROS's convention, and its axes agree: z is up"
              : "is not named an optical frame, and as one it would not be upright",
      ToString(*pose.direction));
}

StatedPose OfSingle(const FrameTransform& t, const std::string& camera, const std::string& lidar) {
  StatedPose pose{
      .transform = t.parent_from_child,
      .basis = fmt::format("it is the pose of {} in {}", Quoted(t.child), Quoted(t.parent))};
  const bool camera_is_parent = t.parent == camera;
  const bool known = !camera.empty() && (lidar.empty() || lidar != camera) &&
                     (lidar == (camera_is_parent ? t.child : t.parent));
  if (!known) {
    pose.basis += ", and these names do not state which is the LiDAR and which the camera";
    return pose;
  }
  pose.direction = camera_is_parent ? PoseDirection::kCamFromLidar : PoseDirection::kLidarFromCam;
  pose.camera_frame = camera;
  pose.lidar_frame = lidar;
  return pose;
}

std::string ListOf(const std::set<std::string>& names) {
  constexpr std::size_t kMaxListed = 12;
  std::string list;
  std::size_t listed = 0;
  for (const std::string& name : names) {
    if (listed++ == kMaxListed)
      return list + fmt::format(" and {} more", names.size() - kMaxListed);
    list += (list.empty() ? "" : ", ") + Quoted(name);
  }
  return list;
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
    StatedPose pose = OfSingle(only, camera, lidar);
    if (!is_marked) DoubtOpticalFrame(pose);
    return pose;
  }
  const Tree in_camera = PosesIn(camera, transforms);
  const auto found = in_camera.find(lidar);
  if (camera.empty() || lidar.empty() || camera == lidar || found == in_camera.end()) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("{}: expected the transform of one LiDAR and one camera, by the "
                                 "names of their frames, or a single transform; its frames are {}",
                                 file, ListOf(names)));
  }
  SEXTANT_RETURN_IF_ERROR(CheckContradictions(in_camera, transforms, lidar, file));
  StatedPose pose{
      .transform = found->second.pose,
      .direction = PoseDirection::kCamFromLidar,
      .basis = fmt::format("its frames {} and {} are connected", Quoted(camera), Quoted(lidar)),
      .camera_frame = camera,
      .lidar_frame = lidar};
  if (!is_marked) DoubtOpticalFrame(pose);
  return pose;
}

bool Agree(const Rigid3d& a, const Rigid3d& b) {
  constexpr double kRounded = 1e-3;
  const PoseDistance apart = DistanceBetween(a, b);
  return apart.rotation_rad < kRounded && apart.translation_m < kRounded;
}

std::string OpticalFrameIn(std::string_view text) {
  constexpr std::string_view kAfter = " is the camera's optical frame";
  const std::size_t end = text.find(kAfter);
  if (end == std::string_view::npos) return {};
  const std::size_t begin = text.find_last_of(" \t\n#", end - 1) + 1;
  return std::string(text.substr(begin, end - begin));
}

bool IsUprightEitherWay(const Rigid3d& pose) {
  const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
  return std::min(rotation(1, 2), rotation(2, 1)) < kUprightCosine;
}

void RecogniseByAxes(StatedPose& pose) {
  // Row y, column z: the part of the LiDAR's z axis along the camera's y axis.
  const Eigen::Matrix3d rotation = pose.transform.rotation.toRotationMatrix();
  const double as_stated = rotation(1, 2);
  const double inverted = rotation(2, 1);
  if (as_stated < kUprightCosine && std::abs(inverted) < -kUprightCosine) {
    pose.direction = PoseDirection::kCamFromLidar;
  } else if (inverted < kUprightCosine && std::abs(as_stated) < -kUprightCosine) {
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
