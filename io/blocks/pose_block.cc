// SPDX-License-Identifier: Apache-2.0
#include "io/blocks/pose_block.h"

#include <fmt/core.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "io/blocks/rigid_matrix.h"

namespace sextant {
namespace {

// A quaternion that has unit length up to rounding is not normalised, so that a file round-trips
// to the same bits.
Eigen::Quaterniond ReadQuaternion(YamlFields& in, const YamlNode& node) {
  std::array<double, 4> wxyz{};
  in.Reals(node, "quaternion_wxyz", wxyz);
  const Eigen::Quaterniond rotation(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  const double excess = rotation.norm() - 1.0;
  if (in.ok() && !(std::abs(excess) < 1e-5)) {
    in.Fail(node.line, "quaternion_wxyz",
            fmt::format("expected length 1, got {:g}", rotation.norm()));
  }
  return std::abs(excess) < 1e-15 ? rotation : rotation.normalized();
}

Rigid3d ReadMatrix(YamlFields& in, const YamlNode& node) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  if (!in.IsSequence(node, "matrix")) return {};
  if (node.items.size() != 4) {
    in.Fail(node.line, "matrix", fmt::format("expected 4 rows, got {}", node.items.size()));
    return {};
  }
  for (int i = 0; i < 4; ++i) {
    Eigen::Vector4d row;
    in.Reals(node.items[static_cast<std::size_t>(i)], "matrix", {row.data(), 4});
    matrix.row(i) = row;
  }
  const std::optional<Rigid3d> pose = RigidFromMatrix(matrix);
  if (in.ok() && !pose) {
    in.Fail(node.line, "matrix", "expected a rotation and a translation above the row 0 0 0 1");
  }
  return pose.value_or(Rigid3d{});
}

}  // namespace

Rigid3d ReadPoseBlock(YamlFields& in, const YamlNode& node, std::string_view what) {
  static const std::vector<std::string> kKeys = {"translation_m", "quaternion_wxyz", "matrix"};
  if (!in.IsMap(node, what, kKeys)) return {};
  if (const YamlNode* matrix = node.Find("matrix")) {
    if (node.items.size() > 1) {
      in.Fail(node.line, what, "expected either matrix or translation_m and quaternion_wxyz");
    }
    return ReadMatrix(in, *matrix);
  }
  Rigid3d pose;
  pose.translation = in.PointAt(node, "translation_m");
  pose.rotation = ReadQuaternion(in, in.Require(node, "quaternion_wxyz"));
  return pose;
}

}  // namespace sextant
