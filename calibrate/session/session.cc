// SPDX-License-Identifier: Apache-2.0
#include "calibrate/session/session.h"

#include <fmt/core.h>

#include <algorithm>
#include <system_error>

#include "base/text/path_text.h"
#include "base/text/printable.h"
#include "calibrate/session/simulated_folder.h"
#include "io/blocks/pose_block.h"
#include "io/text/number_text.h"
#include "io/text/recording_name.h"
#include "io/text/text_file.h"
#include "io/text/yaml_fields.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

bool Exists(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

// Reads a session file; paths in it are relative to its folder.
class SessionReader {
 public:
  explicit SessionReader(const std::string& file)
      : in_(file), folder_(fs::path(file).parent_path()) {}

  Expected<Session> Read(const YamlNode& root) {
    static const std::vector<std::string> kKeys = {
        "sextant_session", "boards", "camera",      "pairs",       "images",
        "clouds",          "bag",    "image_topic", "cloud_topic", "initial_cam_from_lidar"};
    in_.IsMap(root, "session", kKeys);
    in_.IntegerAt(root, "sextant_session", 1, 1);
    session_.boards = PathAt(root, "boards");
    session_.camera = PathAt(root, "camera");
    session_.bag = PathAt(root, "bag");
    session_.image_topic = TextAt(root, "image_topic");
    session_.cloud_topic = TextAt(root, "cloud_topic");
    if (const YamlNode* pose = root.Find("initial_cam_from_lidar")) {
      session_.initial_cam_from_lidar = ReadPoseBlock(in_, *pose, "initial_cam_from_lidar");
    }
    ReadFiles(root);
    if (!in_.ok()) return in_.TakeError();
    return std::move(session_);
  }

 private:
  std::string TextAt(const YamlNode& map, std::string_view key) {
    return map.Find(key) == nullptr ? std::string() : in_.TextAt(map, key);
  }

  fs::path PathAt(const YamlNode& map, std::string_view key) {
    const std::string text = TextAt(map, key);
    return text.empty() ? fs::path() : (folder_ / text).lexically_normal();
  }

  void ReadFiles(const YamlNode& root) {
    const bool has_patterns = root.Find("images") != nullptr || root.Find("clouds") != nullptr;
    const int ways = (root.Find("pairs") != nullptr ? 1 : 0) + (has_patterns ? 1 : 0) +
                     (root.Find("bag") != nullptr ? 1 : 0);
    if (in_.ok() && ways != 1) {
      in_.Fail(root.line, "session", "expected one of pairs, images with clouds, and bag");
    }
    for (const char* topic : {"image_topic", "cloud_topic"}) {
      if (in_.ok() && session_.bag.empty() && root.Find(topic) != nullptr) {
        in_.Fail(root.line, topic, "is for a recording, and this session has files; leave it out");
      }
    }
    if (const YamlNode* pairs = root.Find("pairs")) ReadPairs(*pairs);
    if (has_patterns) ReadPatterns(root);
  }

  void ReadPairs(const YamlNode& pairs) {
    static const std::vector<std::string> kKeys = {"name", "image", "cloud"};
    if (!in_.IsSequence(pairs, "pairs")) return;
    for (const YamlNode& node : pairs.items) {
      if (!in_.IsMap(node, "pairs", kKeys)) return;
      FilePair pair{.name = TextAt(node, "name"),
                    .image = folder_ / in_.TextAt(node, "image"),
                    .cloud = folder_ / in_.TextAt(node, "cloud")};
      if (pair.name.empty()) pair.name = PrintableLine(pair.image.stem().string());
      session_.files.pairs.push_back(std::move(pair));
    }
  }

  void ReadPatterns(const YamlNode& root) {
    const fs::path images = folder_ / in_.TextAt(root, "images");
    const fs::path clouds = folder_ / in_.TextAt(root, "clouds");
    if (!in_.ok()) return;
    const auto image_files = ExpandPattern(images);
    if (!image_files) return in_.Fail(root.line, "images", image_files.error().message);
    const auto cloud_files = ExpandPattern(clouds);
    if (!cloud_files) return in_.Fail(root.line, "clouds", cloud_files.error().message);
    session_.files = PairFiles(*image_files, *cloud_files);
  }

  YamlFields in_;
  fs::path folder_;
  Session session_;
};

Expected<Session> ReadSimulated(const fs::path& folder, const std::string& camera_name) {
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<SimulatedCamera> cameras, SimulatedCameras(folder));
  const std::string camera = camera_name.empty() ? cameras.front().name : camera_name;
  const auto chosen = std::ranges::find(cameras, camera, &SimulatedCamera::name);
  if (chosen == cameras.end()) {
    std::string known;
    for (const SimulatedCamera& one : cameras) known += (known.empty() ? "" : ", ") + one.name;
    return MakeError(ErrorCode::kMissingData, fmt::format("{}: no camera '{}'; there are: {}",
                                                          folder.string(), camera, known));
  }
  Session session{.boards = folder / "boards.yaml", .camera = chosen->info};
  SEXTANT_ASSIGN_OR_RETURN(const auto images, SimulatedImages(folder, camera));
  SEXTANT_ASSIGN_OR_RETURN(const auto clouds, ExpandPattern(folder / "scan_*.pcd"));
  session.files = PairFiles(images, clouds);
  SEXTANT_ASSIGN_OR_RETURN(const auto truth, SimulatedTruth(folder));
  if (const auto pose = truth.find(camera); pose != truth.end()) {
    session.true_cam_from_lidar = pose->second;
  }
  return session;
}

Expected<std::vector<fs::path>> ExpandAll(std::span<const std::string> patterns) {
  std::vector<fs::path> files;
  for (const std::string& pattern : patterns) {
    SEXTANT_ASSIGN_OR_RETURN(const auto some, ExpandPattern(pattern));
    files.insert(files.end(), some.begin(), some.end());
  }
  return files;
}

// As points.txt does; a session file begins with a key or a comment.
bool BeginsWithNumber(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  return begin != std::string_view::npos &&
         std::string_view("+-.0123456789").find(text[begin]) != std::string_view::npos &&
         !text.substr(begin).starts_with("---");
}

tl::unexpected<Error> HintToSolve(const std::string& file) {
  return MakeError(ErrorCode::kParse,
                   fmt::format("{}: expected a session file (YAML with the key sextant_session); "
                               "for a file of correspondences run 'sextant solve' with it",
                               ToString(Place{.file = file})));
}

}  // namespace

Expected<Session> ParseSession(std::string_view text, const std::string& file) {
  if (BeginsWithNumber(text)) return HintToSolve(file);
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  if (root.Find("sextant_problem") != nullptr) return HintToSolve(file);
  if (root.Find("sextant_rig") != nullptr) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: expected a session file; this is a rig file: run 'sextant "
                                 "rig' with it",
                                 ToString(Place{.file = file})));
  }
  if (root.Find("sensors") != nullptr) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: a session of several sensors, which sextant calibrate takes "
                                 "as a rig; expected one camera and one LiDAR",
                                 ToString(Place{.file = file})));
  }
  return SessionReader(file).Read(root);
}

Expected<Session> SessionOfFiles(std::span<const std::string> images,
                                 std::span<const std::string> clouds) {
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<fs::path> image_files, ExpandAll(images));
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<fs::path> cloud_files, ExpandAll(clouds));
  return Session{.files = PairFiles(image_files, cloud_files)};
}

Expected<Session> ReadSession(const fs::path& path, const std::string& camera_name) {
  std::error_code error;
  const bool is_folder = fs::is_directory(path, error);
  const bool has_session = is_folder && Exists(path / "session.yaml");
  const bool is_simulated = is_folder && !has_session && Exists(path / "boards.yaml");
  if (!camera_name.empty() && !is_simulated) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("the camera '{}': only a folder of sextant simulate has cameras with "
                    "names, and '{}' is none; leave the name out",
                    PrintableLine(camera_name), PathText(path)));
  }
  if (!is_folder) {
    if (IsRecording(path)) return Session{.bag = path};
    return ReadWith(path, ParseSession);
  }
  if (has_session) return ReadWith(path / "session.yaml", ParseSession);
  if (is_simulated) return ReadSimulated(path, camera_name);
  for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
    if (IsRecording(it->path())) return Session{.bag = path};
  }
  return MakeError(ErrorCode::kMissingData,
                   fmt::format("{}: expected a folder with session.yaml, one that sextant simulate "
                               "wrote (boards.yaml, <camera>_info.yaml, <camera>_*.png, "
                               "scan_*.pcd) or a recording; or name images and scans with --image "
                               "and --cloud, as in --image 'photos/*.png' --cloud 'scans/*.pcd'",
                               path.string()));
}

}  // namespace sextant
