// SPDX-License-Identifier: Apache-2.0
#include "calibrate/session/simulated_folder.h"

#include <algorithm>
#include <string_view>
#include <system_error>

#include "calibrate/session/file_pairs.h"
#include "io/blocks/pose_block.h"
#include "io/text/text_file.h"
#include "io/text/yaml_fields.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

}  // namespace

Expected<std::vector<SimulatedCamera>> SimulatedCameras(const fs::path& folder) {
  constexpr std::string_view kEnd = "_info";
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<fs::path> infos,
                           ExpandPattern(folder / "*_info.yaml"));
  std::vector<SimulatedCamera> cameras;
  for (const fs::path& info : infos) {
    const std::string stem = info.stem().string();
    cameras.push_back({.name = stem.substr(0, stem.size() - kEnd.size()), .info = info});
  }
  return cameras;
}

Expected<std::vector<fs::path>> SimulatedImages(const fs::path& folder, const std::string& camera) {
  SEXTANT_ASSIGN_OR_RETURN(std::vector<fs::path> images,
                           ExpandPattern(folder / (camera + "_*.png")));
  std::erase_if(images, [&camera](const fs::path& image) {
    const std::string number = image.stem().string().substr(camera.size() + 1);
    return !std::ranges::all_of(number, [](char c) { return c >= '0' && c <= '9'; });
  });
  return images;
}

Expected<std::map<std::string, Rigid3d>> SimulatedTruth(const fs::path& folder) {
  std::map<std::string, Rigid3d> poses;
  const fs::path path = folder / "truth.yaml";
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return poses;
  SEXTANT_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path));
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, path.string()));
  const YamlNode* cameras = root.Find("cameras");
  if (cameras == nullptr) return poses;
  for (const YamlNode& node : cameras->items) {
    const YamlNode* name = node.Find("camera");
    const YamlNode* pose = node.Find("cam_from_lidar");
    if (name == nullptr || pose == nullptr) continue;
    YamlFields in(path.string());
    poses.emplace(name->text, ReadPoseBlock(in, *pose, "cam_from_lidar"));
    if (!in.ok()) return in.TakeError();
  }
  return poses;
}

}  // namespace sextant
