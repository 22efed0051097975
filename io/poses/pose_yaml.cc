// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <optional>

#include "io/blocks/rigid_matrix.h"
#include "io/poses/pose_parts.h"
#include "io/results/results_json.h"
#include "io/text/yaml_fields.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxTruthCameras = 16;  // As many as a scene may have.

bool IsMapNode(const YamlNode* node) {
  return node != nullptr && node->kind == YamlNode::Kind::kMap;
}

// Four rows of four, sixteen or twelve numbers, or OpenCV's map with `data`.
std::optional<Rigid3d> MatrixAt(YamlFields& in, const YamlNode& node) {
  const YamlNode* data = node.Find("data");
  const YamlNode& list = data != nullptr ? *data : node;
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
  const std::size_t size = list.items.size();
  if (size == 3 || size == 4) {
    for (std::size_t row = 0; row < size; ++row) {
      in.Reals(list.items[row], "matrix", {matrix.data() + 4 * row, 4});
    }
  } else {
    in.Reals(list, "matrix", {matrix.data(), size == 12U ? 12U : 16U});
  }
  if (!in.ok()) return std::nullopt;
  const std::optional<Rigid3d> pose = RigidFromMatrix(matrix);
  if (!pose) in.Fail(node.line, "matrix", "expected a rotation and a translation");
  return pose;
}

// translation_m and quaternion_wxyz, or a matrix.
Expected<Rigid3d> KeyedPose(YamlFields& in, const YamlNode& node) {
  if (node.Find("translation_m") == nullptr || node.Find("quaternion_wxyz") == nullptr) {
    const YamlNode* matrix = node.Find("matrix");
    const std::optional<Rigid3d> pose = MatrixAt(in, matrix != nullptr ? *matrix : node);
    if (!pose) return in.TakeError();
    return *pose;
  }
  std::array<double, 3> translation{};
  std::array<double, 4> wxyz{};
  in.Reals(in.Require(node, "translation_m"), "translation_m", translation);
  in.Reals(in.Require(node, "quaternion_wxyz"), "quaternion_wxyz", wxyz);
  if (!in.ok()) return in.TakeError();
  return PoseOfNumbers(translation, wxyz, in.file(), node.line);
}

// lidar_from_cam beside cam_from_lidar must be its inverse.
Expected<void> CheckInverse(YamlFields& in, const Rigid3d& cam_from_lidar, int line,
                            const YamlNode& node) {
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d lidar_from_cam, KeyedPose(in, node));
  if (Agree(lidar_from_cam.Inverse(), cam_from_lidar)) return {};
  return MakeError(ErrorCode::kParse,
                   fmt::format("{}: cam_from_lidar at line {} and lidar_from_cam at line {} "
                               "contradict each other; expected one of them, or the inverse",
                               in.file(), line, node.line));
}

Expected<StatedPose> FromKey(YamlFields& in, const YamlNode& root, PoseDirection direction) {
  const std::string key(ToString(direction));
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d transform, KeyedPose(in, *root.Find(key)));
  if (const YamlNode* other = root.Find("lidar_from_cam");
      other != nullptr && other != root.Find(key)) {
    SEXTANT_RETURN_IF_ERROR(CheckInverse(in, transform, root.Find(key)->line, *other));
  }
  const auto name = [&](const char* frame, const char* otherwise) {
    return root.Find(frame) != nullptr ? in.TextAt(root, frame) : std::string(otherwise);
  };
  StatedPose pose{.transform = transform,
                  .direction = direction,
                  .basis = "its key " + key,
                  .camera_frame = name("camera_frame", "camera"),
                  .lidar_frame = name("lidar_frame", "lidar"),
                  .is_result = root.Find("sextant_result") != nullptr};
  if (!in.ok()) return in.TakeError();
  return pose;
}

FrameTransform StampedTransform(YamlFields& in, const YamlNode& node) {
  FrameTransform t;
  t.line = node.line;
  t.parent = in.TextAt(in.Require(node, "header"), "frame_id");
  t.child = in.TextAt(node, "child_frame_id");
  const YamlNode& transform = in.Require(node, "transform");
  const YamlNode& translation = in.Require(transform, "translation");
  const YamlNode& rotation = in.Require(transform, "rotation");
  const std::array<double, 3> xyz = {in.RealAt(translation, "x"), in.RealAt(translation, "y"),
                                     in.RealAt(translation, "z")};
  const std::array<double, 4> wxyz = {in.RealAt(rotation, "w"), in.RealAt(rotation, "x"),
                                      in.RealAt(rotation, "y"), in.RealAt(rotation, "z")};
  if (!in.ok()) return t;
  const Expected<Rigid3d> pose = PoseOfNumbers(xyz, wxyz, in.file(), node.line);
  if (!pose) in.Fail(pose.error());
  if (pose) t.parent_from_child = *pose;
  return t;
}

// The arguments of every static_transform_publisher of a ROS 2 launch file.
void AddLaunched(YamlFields& in, const YamlNode& node, std::vector<FrameTransform>& transforms) {
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const YamlNode& item = node.items[i];
    const bool is_node = node.kind == YamlNode::Kind::kMap && node.keys[i] == "node";
    const YamlNode* exec = is_node ? item.Find("exec") : nullptr;
    if (exec == nullptr || exec->text != "static_transform_publisher") {
      AddLaunched(in, item, transforms);
      continue;
    }
    const Expected<FrameTransform> t =
        PublishedTransform(in.TextAt(item, "args"), in.file(), item.line);
    if (!t) in.Fail(t.error());
    if (t) transforms.push_back(*t);
  }
}

std::vector<FrameTransform> FramesOfYaml(YamlFields& in, const YamlNode& root) {
  std::vector<FrameTransform> transforms;
  if (const YamlNode* list = root.Find("transforms")) {
    if (!in.IsSequence(*list, "transforms")) return transforms;
    for (const YamlNode& node : list->items) transforms.push_back(StampedTransform(in, node));
  } else if (root.Find("child_frame_id") != nullptr) {
    transforms.push_back(StampedTransform(in, root));
  } else if (const YamlNode* launch = root.Find("launch")) {
    AddLaunched(in, *launch, transforms);
  }
  return transforms;
}

Expected<StatedPose> FromExtrinsics(YamlFields& in, const YamlNode& node) {
  std::array<double, 3> translation{};
  std::array<double, 4> wxyz{};
  in.Reals(in.Require(node, "translation"), "translation", translation);
  in.Reals(in.Require(node, "rotation"), "rotation", wxyz);
  if (!in.ok()) return in.TakeError();
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d transform,
                           PoseOfNumbers(translation, wxyz, in.file(), node.line));
  StatedPose pose{.transform = transform};
  RecogniseByAxes(pose);
  pose.basis += ", with the rotation read as a quaternion w x y z";
  if (IsUprightEitherWay({Eigen::Quaterniond(wxyz[3], wxyz[0], wxyz[1], wxyz[2]), {}})) {
    pose.basis += " (read as x y z w it would be upright too)";
  }
  return pose;
}

Expected<StatedPose> FromSolve(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const ResultFile results, ParseResults(text, file));
  for (const SolverResult& result : results.results) {
    if (!result.report) continue;
    return StatedPose{.transform = result.report->cam_from_lidar,
                      .direction = PoseDirection::kCamFromLidar,
                      .basis = "the answer of " + result.solver,
                      .camera_frame = "camera",
                      .lidar_frame = "lidar"};
  }
  return MakeError(ErrorCode::kMissingData, file + ": expected a result with an answer");
}

// The camera with the name; without one, the only camera.
Expected<const YamlNode*> ChosenCamera(YamlFields& in, const YamlNode& root,
                                       std::string_view name) {
  const YamlNode& cameras = in.Require(root, "cameras");
  std::string all;
  const YamlNode* chosen = nullptr;
  if (in.ok() && in.IsSequence(cameras, "cameras", kMaxTruthCameras)) {
    for (const YamlNode& camera : cameras.items) {
      const std::string its_name = in.TextAt(camera, "camera");
      if (its_name == name || (name.empty() && cameras.items.size() == 1)) chosen = &camera;
      all += (all.empty() ? "" : ", ") + its_name;
    }
  }
  if (!in.ok()) return in.TakeError();
  if (chosen != nullptr) return chosen;
  if (!name.empty()) {
    return MakeError(ErrorCode::kUnknownName, fmt::format("{}: has no camera {}; there are: {}",
                                                          in.file(), Quoted(name), all));
  }
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("{0}: expected the name of one of its cameras behind a colon, as in "
                               "{0}:NAME; there are: {1}",
                               in.file(), all.empty() ? "none" : all));
}

// `ros2 topic echo` ends each message with this line.
std::string_view FirstMessage(std::string_view text) {
  while (text.ends_with('\n') || text.ends_with('\r')) text.remove_suffix(1);
  if (text.ends_with("\n---")) text.remove_suffix(3);
  return text;
}

}  // namespace

Expected<StatedPose> ParsePoseTruth(std::string_view text, const std::string& file,
                                    std::string_view name) {
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  YamlFields in(file);
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode* camera, ChosenCamera(in, root, name));
  const YamlNode& pose = in.Require(*camera, "cam_from_lidar");
  if (!in.ok()) return in.TakeError();
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d cam_from_lidar, KeyedPose(in, pose));
  return StatedPose{.transform = cam_from_lidar,
                    .direction = PoseDirection::kCamFromLidar,
                    .basis = "its key cam_from_lidar",
                    .camera_frame = "camera",
                    .lidar_frame = "lidar"};
}

Expected<StatedPose> ParsePoseYaml(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(FirstMessage(text), file));
  YamlFields in(file);
  for (const PoseDirection direction :
       {PoseDirection::kCamFromLidar, PoseDirection::kLidarFromCam}) {
    if (root.Find(ToString(direction)) != nullptr) return FromKey(in, root, direction);
  }
  if (root.Find("results") != nullptr) return FromSolve(text, file);
  if (const YamlNode* node = root.Find("extrinsics"); IsMapNode(node)) {
    return FromExtrinsics(in, *node);
  }
  const std::vector<FrameTransform> transforms = FramesOfYaml(in, root);
  if (!in.ok()) return in.TakeError();
  if (!transforms.empty()) return ConnectFrames(transforms, OpticalFrameIn(text), file);
  return MakeError(
      ErrorCode::kMissingData,
      fmt::format("{}: expected a pose: the key cam_from_lidar or lidar_from_cam, a "
                  "TransformStamped, static transforms of ROS, a URDF, KITTI's calibration, a 4x4 "
                  "matrix in rows, or x y z qx qy qz qw",
                  file));
}

}  // namespace sextant
