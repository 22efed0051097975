// SPDX-License-Identifier: Apache-2.0
#include "io/results/optional_fields.h"

#include <fmt/core.h>

#include <initializer_list>

#include "io/blocks/pose_block.h"

namespace sextant {

const YamlNode* Present(const YamlNode& map, std::string_view key) {
  const YamlNode* node = map.Find(key);
  return node == nullptr || node->kind == YamlNode::Kind::kNull ? nullptr : node;
}

std::string OptionalText(YamlFields& in, const YamlNode& map, std::string_view key) {
  return Present(map, key) != nullptr ? in.TextAt(map, key) : std::string();
}

std::optional<double> OptionalReal(YamlFields& in, const YamlNode& map, std::string_view key) {
  const YamlNode* node = Present(map, key);
  if (node == nullptr) return std::nullopt;
  return in.Real(*node, key);
}

std::optional<double> OptionalNonNegative(YamlFields& in, const YamlNode& map,
                                          std::string_view key) {
  if (Present(map, key) == nullptr) return std::nullopt;
  return in.NonNegativeAt(map, key, 0.0);
}

Rigid3d ReadPose(YamlFields& in, const YamlNode& node, std::string_view key) {
  static const std::vector<std::string> kKeys = {"matrix", "translation_m", "quaternion_wxyz",
                                                 "euler_zyx_deg"};
  if (!in.IsMap(node, key, kKeys)) return {};
  const auto block_of = [&node](std::initializer_list<const char*> keys) {
    YamlNode block;
    block.kind = YamlNode::Kind::kMap;
    block.line = node.line;
    for (const char* name : keys) {
      if (const YamlNode* value = Present(node, name)) {
        block.keys.emplace_back(name);
        block.items.push_back(*value);
      }
    }
    return block;
  };
  const YamlNode* matrix = Present(node, "matrix");
  const YamlNode numbers = block_of({"translation_m", "quaternion_wxyz"});
  if (matrix != nullptr && numbers.items.empty()) {
    return ReadPoseBlock(in, block_of({"matrix"}), key);
  }
  Rigid3d pose = ReadPoseBlock(in, numbers, key);
  if (matrix == nullptr || !in.ok()) return pose;
  const Rigid3d other = ReadPoseBlock(in, block_of({"matrix"}), key);
  if (in.ok() && !(PoseDifference(other, pose).cwiseAbs().maxCoeff() < 1e-5)) {
    in.Fail(matrix->line, "matrix",
            "expected the pose of translation_m and quaternion_wxyz; was one of them edited?");
  }
  return pose;
}

std::optional<Rigid3d> OptionalPose(YamlFields& in, const YamlNode& map, std::string_view key) {
  const YamlNode* node = Present(map, key);
  if (node == nullptr) return std::nullopt;
  return ReadPose(in, *node, key);
}

Vector6d ReadVector6(YamlFields& in, const YamlNode& node, std::string_view key) {
  Vector6d values = Vector6d::Zero();
  in.Reals(node, key, {values.data(), 6});
  return values;
}

std::optional<Vector6d> OptionalVector6(YamlFields& in, const YamlNode& map, std::string_view key) {
  const YamlNode* node = Present(map, key);
  if (node == nullptr) return std::nullopt;
  return ReadVector6(in, *node, key);
}

std::optional<Matrix6d> OptionalSymmetric(YamlFields& in, const YamlNode& map,
                                          std::string_view key) {
  const YamlNode* node = Present(map, key);
  if (node == nullptr || !in.IsSequence(*node, key)) return std::nullopt;
  if (node->items.size() != 6) {
    in.Fail(node->line, key, fmt::format("expected 6 rows, got {}", node->items.size()));
    return std::nullopt;
  }
  Matrix6d matrix;
  for (int i = 0; i < 6; ++i) {
    matrix.row(i) = ReadVector6(in, node->items[static_cast<std::size_t>(i)], key).transpose();
  }
  const double scale = matrix.cwiseAbs().maxCoeff();
  if (in.ok() && !((matrix - matrix.transpose()).cwiseAbs().maxCoeff() <= 1e-9 * scale &&
                   matrix.diagonal().minCoeff() >= 0.0)) {
    in.Fail(node->line, key, "expected a symmetric matrix with no negative number on its diagonal");
  }
  return matrix;
}

std::vector<std::string> ReadTexts(YamlFields& in, const YamlNode& map, std::string_view key) {
  std::vector<std::string> texts;
  const YamlNode* list = Present(map, key);
  if (list == nullptr || !in.IsSequence(*list, key)) return texts;
  for (const YamlNode& node : list->items) texts.push_back(in.Text(node, key));
  return texts;
}

}  // namespace sextant
