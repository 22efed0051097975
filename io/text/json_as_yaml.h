// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace sextant {

/// Formats a JSON object as human-readable YAML: maps in block style, lists of numbers on one line,
/// text in double quotes, numbers in the shortest form that reads back to the same bits. Keys whose
/// value is null are omitted.
std::string JsonAsYaml(const nlohmann::ordered_json& map);

}  // namespace sextant
