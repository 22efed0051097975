// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/core.h>

#include <Eigen/Core>
#include <iterator>
#include <span>
#include <string>
#include <utility>

#include "geometry/rigid3d.h"
#include "io/text/yaml_node.h"

namespace sextant {

/// Collects lines of YAML; numbers are written in the shortest form that reads back to the same
/// bits (at most 17 digits).
class YamlText {
 public:
  template <class... Values>
  void Line(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Values>(values)...);
    text_ += '\n';
  }
  std::string Take() { return std::move(text_); }

 private:
  std::string text_;
};

/// "[1, 2.5, 3]".
std::string YamlList(std::span<const double> values);

template <int kSize>
std::string YamlList(const Eigen::Matrix<double, kSize, 1>& values) {
  return YamlList(std::span<const double>(values.data(), static_cast<std::size_t>(values.size())));
}

/// Writes the lines translation_m and quaternion_wxyz, each after `indent`.
void WriteYamlPose(YamlText& out, const std::string& indent, const Rigid3d& pose);

/// "{translation_m: [..], quaternion_wxyz: [..]}".
std::string YamlPose(const Rigid3d& pose);

}  // namespace sextant
