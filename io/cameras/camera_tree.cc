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

bool HoldsCamera(const YamlNode& map) {
  if (const YamlNode* matrix =
          FindCameraKey(map, {"camera_matrix", "K", "k", "cameraMatrix", "cam_K"})) {
    return matrix->kind != YamlNode::Kind::kNull;
  }
  if (FindCameraKey(map, {"fx", "f_x", "cam_fx", "Camera.fx", "gamma1", "mu"}) != nullptr) {
    return true;
  }
  const YamlNode* list = map.Find("intrinsics");
  return list != nullptr && list->kind == YamlNode::Kind::kSequence;
}

// P2, P_rect_02: the projection matrices of KITTI's calibration files.
bool IsKittiProjection(const std::string& key, const YamlNode& value) {
  if (value.kind != YamlNode::Kind::kText) return false;
  const bool is_name = (key.size() == 2 && key[0] == 'P') || key.starts_with("P_rect_");
  return is_name && key.back() >= '0' && key.back() <= '9';
}

void AddCameras(const std::string& name, const YamlNode& node, std::vector<CameraNode>& cameras) {
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
