// SPDX-License-Identifier: Apache-2.0
#include "calibrate/session/rig_session.h"

#include <fmt/core.h>

#include <algorithm>
#include <system_error>

#include "base/text/path_text.h"
#include "io/blocks/pose_block.h"
#include "io/text/text_file.h"
#include "io/text/yaml_fields.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxSensors = 100;

bool IsFile(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

void GroupMoments(RigSession& session) {
  std::vector<std::vector<fs::path>> files;
  for (const SessionSensor& sensor : session.sensors) files.push_back(sensor.files);
  session.moments = GroupFiles(files);
}

/// Reads a session file with the key sensors; paths in it are relative to its folder.
class RigSessionReader {
 public:
  explicit RigSessionReader(const std::string& file)
      : in_(file), folder_(fs::path(file).parent_path()) {}

  Expected<RigSession> Read(const YamlNode& root) {
    static const std::vector<std::string> kKeys = {"sextant_session", "boards", "sensors", "root"};
    if (in_.IsMap(root, "session", kKeys)) {
      in_.IntegerAt(root, "sextant_session", 1, 1);
      if (root.Find("boards") != nullptr) session_.boards = folder_ / in_.TextAt(root, "boards");
      ReadSensors(in_.Require(root, "sensors"));
      if (const YamlNode* name = root.Find("root")) ReadRoot(*name);
    }
    if (!in_.ok()) return in_.TakeError();
    GroupMoments(session_);
    return std::move(session_);
  }

 private:
  void ReadSensors(const YamlNode& list) {
    static const std::vector<std::string> kKeys = {"name", "camera", "images", "clouds"};
    if (!in_.IsSequence(list, "sensors", kMaxSensors)) return;
    for (const YamlNode& node : list.items) {
      if (!in_.IsMap(node, "sensors", kKeys)) return;
      SessionSensor sensor{.name = in_.FileName(in_.Require(node, "name"), "name")};
      const bool images = node.Find("images") != nullptr;
      const bool camera = node.Find("camera") != nullptr;
      if (in_.ok() && (images == (node.Find("clouds") != nullptr) || images != camera)) {
        return in_.Fail(node.line, "sensors",
                        "expected images with camera (its intrinsics), or clouds");
      }
      if (camera) sensor.camera = folder_ / in_.TextAt(node, "camera");
      const char* key = images ? "images" : "clouds";
      const fs::path pattern = folder_ / in_.TextAt(node, key);
      if (!in_.ok()) return;
      auto files = ExpandPattern(pattern);
      if (!files) return in_.Fail(node.line, key, files.error().message);
      sensor.files = std::move(*files);
      session_.sensors.push_back(std::move(sensor));
    }
  }

  void ReadRoot(const YamlNode& node) {
    const std::string name = in_.Text(node, "root");
    const auto at = std::ranges::find(session_.sensors, name, &SessionSensor::name);
    session_.root = static_cast<std::size_t>(at - session_.sensors.begin());
    if (in_.ok() && at == session_.sensors.end()) {
      in_.Fail(node.line, "root", "expected the name of one of the sensors");
    }
  }

  YamlFields in_;
  fs::path folder_;
  RigSession session_;
};

// The true poses in truth.yaml, in the frame of the LiDAR; everything else in it is ignored.
Expected<void> AddTruth(const fs::path& path, RigSession& session) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path));
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, path.string()));
  const YamlNode* cameras = root.Find("cameras");
  if (cameras == nullptr) return {};
  for (SessionSensor& sensor : session.sensors) {
    if (sensor.camera.empty()) sensor.true_rig_from_sensor = Rigid3d{};
    for (const YamlNode& node : cameras->items) {
      const YamlNode* name = node.Find("camera");
      const YamlNode* pose = node.Find("cam_from_lidar");
      if (name == nullptr || pose == nullptr || name->text != sensor.name) continue;
      YamlFields in(path.string());
      sensor.true_rig_from_sensor = ReadPoseBlock(in, *pose, "cam_from_lidar").Inverse();
      if (!in.ok()) return in.TakeError();
    }
  }
  return {};
}

// With cameras cam and cam_right, cam_*.png also matches the images of cam_right.
std::vector<fs::path> Numbered(const std::vector<fs::path>& images, std::size_t prefix) {
  std::vector<fs::path> own;
  const auto is_number = [](char c) { return c >= '0' && c <= '9'; };
  for (const fs::path& image : images) {
    if (std::ranges::all_of(image.stem().string().substr(prefix), is_number)) own.push_back(image);
  }
  return own;
}

Expected<std::optional<RigSession>> ReadSimulatedRig(const fs::path& folder) {
  SEXTANT_ASSIGN_OR_RETURN(const auto infos, ExpandPattern(folder / "*_info.yaml"));
  if (infos.size() < 2) return std::optional<RigSession>();
  if (infos.size() > kMaxSensors) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("the folder '{}' has {} files *_info.yaml, expected at most {} "
                                 "cameras",
                                 PathText(folder), infos.size(), kMaxSensors));
  }
  RigSession session{.boards = folder / "boards.yaml"};
  SessionSensor lidar{.name = "lidar"};
  SEXTANT_ASSIGN_OR_RETURN(lidar.files, ExpandPattern(folder / "scan_*.pcd"));
  session.sensors.push_back(std::move(lidar));
  for (const fs::path& info : infos) {
    const std::string stem = info.stem().string();
    SessionSensor sensor{.name = stem.substr(0, stem.size() - std::string("_info").size()),
                         .camera = info};
    SEXTANT_ASSIGN_OR_RETURN(const auto images, ExpandPattern(folder / (sensor.name + "_*.png")));
    sensor.files = Numbered(images, sensor.name.size() + 1);
    session.sensors.push_back(std::move(sensor));
  }
  if (IsFile(folder / "truth.yaml")) {
    SEXTANT_RETURN_IF_ERROR(AddTruth(folder / "truth.yaml", session));
  }
  GroupMoments(session);
  return std::optional<RigSession>(std::move(session));
}

}  // namespace

Expected<std::optional<RigSession>> ReadRigSession(const fs::path& path) {
  std::error_code error;
  fs::path file = path;
  if (fs::is_directory(path, error)) {
    file = path / "session.yaml";
    if (!IsFile(file)) {
      return IsFile(path / "boards.yaml") ? ReadSimulatedRig(path) : std::optional<RigSession>();
    }
  }
  const std::string extension = file.extension().string();
  if (!IsFile(file) || (extension != ".yaml" && extension != ".yml")) {
    return std::optional<RigSession>();
  }
  SEXTANT_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(file));
  const Expected<YamlNode> root = ParseYaml(text, file.string());
  if (!root || root->kind != YamlNode::Kind::kMap || root->Find("sensors") == nullptr ||
      root->Find("sextant_session") == nullptr) {
    return std::optional<RigSession>();
  }
  SEXTANT_ASSIGN_OR_RETURN(RigSession session, RigSessionReader(file.string()).Read(*root));
  return std::optional<RigSession>(std::move(session));
}

}  // namespace sextant
