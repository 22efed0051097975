// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace sextant {

/// A map as lines of YAML that a person can read: maps in blocks, lists of numbers on one line,
/// text in double quotes, numbers in the fewest digits that read back to the same bits. A key whose
/// value is null is left out.
std::string JsonAsYaml(const nlohmann::ordered_json& map);

}  // namespace sextant
