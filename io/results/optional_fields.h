// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/rigid3d.h"
#include "io/text/yaml_fields.h"

// Values of result files that may be absent. Errors go to `in` and name the key.
namespace sextant {

/// The value of a key; null if it is absent or, as in JSON, null.
const YamlNode* Present(const YamlNode& map, std::string_view key);

/// Empty if absent.
std::string OptionalText(YamlFields& in, const YamlNode& map, std::string_view key);
std::optional<double> OptionalReal(YamlFields& in, const YamlNode& map, std::string_view key);
std::optional<double> OptionalNonNegative(YamlFields& in, const YamlNode& map,
                                          std::string_view key);

/// A pose as PoseJson and results in YAML state it: translation and quaternion, and a matrix and
/// angles for people and other tools. A matrix that differs is an error: the file was edited in one
/// place only.
Rigid3d ReadPose(YamlFields& in, const YamlNode& node, std::string_view key);
std::optional<Rigid3d> OptionalPose(YamlFields& in, const YamlNode& map, std::string_view key);

/// Six numbers.
Vector6d ReadVector6(YamlFields& in, const YamlNode& node, std::string_view key);
std::optional<Vector6d> OptionalVector6(YamlFields& in, const YamlNode& map, std::string_view key);

/// Six rows of six numbers, symmetric and without a negative number on the diagonal.
std::optional<Matrix6d> OptionalSymmetric(YamlFields& in, const YamlNode& map,
                                          std::string_view key);

/// A list of lines; empty if absent.
std::vector<std::string> ReadTexts(YamlFields& in, const YamlNode& map, std::string_view key);

}  // namespace sextant
