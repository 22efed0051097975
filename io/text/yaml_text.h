// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/core.h>

#include <Eigen/Core>
#include <iterator>
#include <span>
#include <string>
#include <utility>

#include "geometry/rigid3d.h"

namespace sextant {

/// Lines of YAML, numbers in the fewest digits that read back to the same bits (at most 17).
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

/// In double quotes, with what needs it escaped.
std::string YamlQuoted(const std::string& text);

/// The lines translation_m and quaternion_wxyz, each after `indent`.
void WriteYamlPose(YamlText& out, const std::string& indent, const Rigid3d& pose);

/// "{translation_m: [..], quaternion_wxyz: [..]}".
std::string YamlPose(const Rigid3d& pose);

}  // namespace sextant
