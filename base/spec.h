// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"

namespace sextant {

/// The parsed spec of a composed solver: `refine(ransac(kabsch, seed=7), loss=huber)`.
struct SpecNode {
  std::string name;             ///< At most 100 characters, as keys and values.
  std::vector<SpecNode> inner;  ///< The solvers in the parentheses.
  std::vector<std::pair<std::string, std::string>> options;  ///< key=value, in the order given.
};

/// Grammar: spec = name [ "(" [ argument { "," argument } ] ")" ], argument = spec | key "=" value.
/// Names consist of letters, digits, '_' and '.'; blanks are ignored. Error: kParse, with the
/// column.
/// At most 32 levels; time is linear in the text, memory at most 100 times it.
Expected<SpecNode> ParseSpec(std::string_view text);

/// Specs separated by commas outside parentheses.
Expected<std::vector<SpecNode>> ParseSpecList(std::string_view text);

/// The canonical text, without blanks: ParseSpec(FormatSpec(node)) gives the same node.
std::string FormatSpec(const SpecNode& node);

}  // namespace sextant
