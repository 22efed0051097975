// SPDX-License-Identifier: Apache-2.0
#include "io/text/yaml_text.h"

#include <fmt/format.h>

namespace sextant {
namespace {

std::string Quaternion(const Eigen::Quaterniond& q) {
  return fmt::format("[{}, {}, {}, {}]", q.w(), q.x(), q.y(), q.z());
}

}  // namespace

std::string YamlList(std::span<const double> values) {
  return fmt::format("[{}]", fmt::join(values, ", "));
}

void WriteYamlPose(YamlText& out, const std::string& indent, const Rigid3d& pose) {
  out.Line("{}translation_m: {}", indent, YamlList(pose.translation));
  out.Line("{}quaternion_wxyz: {}", indent, Quaternion(pose.rotation));
}

std::string YamlPose(const Rigid3d& pose) {
  return fmt::format("{{translation_m: {}, quaternion_wxyz: {}}}", YamlList(pose.translation),
                     Quaternion(pose.rotation));
}

}  // namespace sextant
