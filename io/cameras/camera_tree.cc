// SPDX-License-Identifier: Apache-2.0
#include "io/cameras/camera_tree.h"

#include <fmt/core.h>

#include <algorithm>
#include <sstream>

namespace sextant {
namespace {

constexpr std::string_view kGroups[] = {"projection_parameters", "distortion_parameters",
                                        "mirror_parameters"};

bool IsMap(const YamlNode& node) { return node.kind == YamlNode::Kind::kMap; }

bool IsSequence(const YamlNode& node) { return node.kind == YamlNode::Kind::kSequence; }

bool HoldsCamera(const YamlNode& map) {
  if (const YamlNode* matrix = FindCameraKey(map, CameraMatrixKeys())) {
    // nuScenes lists a LiDAR's empty matrix, too.
    return matrix->kind != YamlNode::Kind::kNull && !(IsSequence(*matrix) && matrix->items.empty());
  }
  if (FindCameraKey(map, {"fx", "f_x", "cam_fx", "Camera.fx", "Camera1.fx", "gamma1", "mu"})) {
    return true;
  }
  for (const std::string_view key : {"intrinsics", "intrinsic", "fc", "FocalLength"}) {
    const YamlNode* list = map.Find(key);
    if (list != nullptr && IsSequence(*list)) return true;
  }
  return false;
}

// P2, P_rect_02: the projection matrices of KITTI's calibration files.
bool IsKittiProjection(const std::string& key, const YamlNode& value) {
  if (value.kind != YamlNode::Kind::kText) return false;
  const bool is_name = (key.size() == 2 && key[0] == 'P') || key.starts_with("P_rect_");
  return is_name && key.back() >= '0' && key.back() <= '9';
}

// The name that an item of a list has, else its place.
std::string NameOfItem(const YamlNode& item, std::size_t place) {
  for (const std::string_view key : {"camera_name", "name", "channel", "token", "id"}) {
    const YamlNode* name = item.Find(key);
    if (name != nullptr && name->kind == YamlNode::Kind::kText) return name->text;
  }
  return std::to_string(place);
}

void AddCameras(const std::string& name, const YamlNode& node, std::vector<CameraNode>& cameras) {
  if (IsSequence(node)) {
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      if (IsMap(node.items[i])) AddCameras(NameOfItem(node.items[i], i), node.items[i], cameras);
    }
  }
  if (!IsMap(node)) return;
  if (HoldsCamera(node)) {
    cameras.push_back({name, &node, nullptr});
    return;
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    if (IsKittiProjection(node.keys[i], node.items[i])) {
      cameras.push_back({node.keys[i], &node, &node.items[i]});
    } else {
      AddCameras(node.keys[i], node.items[i], cameras);
    }
  }
}

void AddNumbers(YamlFields& in, const YamlNode& node, std::string_view name,
                std::vector<double>& numbers) {
  if (IsMap(node)) return AddNumbers(in, in.Require(node, "data"), name, numbers);
  if (node.kind == YamlNode::Kind::kSequence) {
    for (const YamlNode& item : node.items) AddNumbers(in, item, name, numbers);
    return;
  }
  YamlNode number = node;
  std::istringstream words(node.text);
  while (words >> number.text) numbers.push_back(in.Real(number, name));
}

}  // namespace

const std::vector<std::string_view>& CameraMatrixKeys() {
  static const std::vector<std::string_view> keys = {
      "camera_matrix",    "Camera_Matrix",   "K",         "k",
      "cameraMatrix",     "cam_K",           "CameraMat", "camera_intrinsic",
      "intrinsic_matrix", "IntrinsicMatrix", "M1",        "K1"};
  return keys;
}

std::vector<CameraNode> FindCameras(const YamlNode& root) {
  std::vector<CameraNode> cameras;
  AddCameras({}, root, cameras);
  return cameras;
}

const YamlNode* FindCameraKey(const YamlNode& camera, const std::vector<std::string_view>& keys) {
  for (const std::string_view key : keys) {
    if (const YamlNode* found = camera.Find(key)) return found;
    for (const std::string_view group : kGroups) {
      const YamlNode* map = camera.Find(group);
      if (map == nullptr) continue;
      if (const YamlNode* found = map->Find(key)) return found;
    }
  }
  return nullptr;
}

std::vector<double> CameraNumbers(YamlFields& in, const YamlNode& node, std::string_view name,
                                  std::size_t max_size) {
  std::vector<double> numbers;
  AddNumbers(in, node, name, numbers);
  if (in.ok() && numbers.size() > max_size) {
    in.Fail(node.line, name,
            fmt::format("expected at most {} numbers, got {}", max_size, numbers.size()));
  }
  return numbers;
}

}  // namespace sextant
