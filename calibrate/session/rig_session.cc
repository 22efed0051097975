// SPDX-License-Identifier: Apache-2.0
#include "calibrate/session/rig_session.h"

#include <fmt/core.h>

#include <algorithm>
#include <system_error>

#include "base/text/path_text.h"
#include "calibrate/session/session.h"
#include "calibrate/session/simulated_folder.h"
#include "io/text/recording_name.h"
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

// The true poses, in the frame of the LiDAR.
Expected<void> AddTruth(const fs::path& folder, RigSession& session) {
  SEXTANT_ASSIGN_OR_RETURN(const auto truth, SimulatedTruth(folder));
  if (truth.empty()) return {};
  for (SessionSensor& sensor : session.sensors) {
    if (sensor.camera.empty()) sensor.true_rig_from_sensor = Rigid3d{};
    const auto pose = truth.find(sensor.name);
    if (pose != truth.end()) sensor.true_rig_from_sensor = pose->second.Inverse();
  }
  return {};
}

Expected<std::optional<RigSession>> ReadSimulatedRig(const fs::path& folder) {
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<SimulatedCamera> cameras, SimulatedCameras(folder));
  if (cameras.size() < 2) return std::optional<RigSession>();
  if (cameras.size() > kMaxSensors) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("the folder '{}' has {} files *_info.yaml, expected at most {} "
                                 "cameras",
                                 PathText(folder), cameras.size(), kMaxSensors));
  }
  RigSession session{.boards = folder / "boards.yaml"};
  SessionSensor lidar{.name = "lidar"};
  SEXTANT_ASSIGN_OR_RETURN(lidar.files, ExpandPattern(folder / "scan_*.pcd"));
  session.sensors.push_back(std::move(lidar));
  for (const SimulatedCamera& camera : cameras) {
    SessionSensor sensor{.name = camera.name, .camera = camera.info};
    SEXTANT_ASSIGN_OR_RETURN(sensor.files, SimulatedImages(folder, camera.name));
    session.sensors.push_back(std::move(sensor));
  }
  SEXTANT_RETURN_IF_ERROR(AddTruth(folder, session));
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
  if (!IsFile(file) || IsRecording(file)) return std::optional<RigSession>();
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
