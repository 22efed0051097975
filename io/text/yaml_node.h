// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

/// A YAML document as a plain tree that knows its lines.
///
/// Narrower than YAML on purpose, so that a hostile file costs no more than its size: no aliases
/// (a few lines of them can stand for billions of values), at most kMaxYamlDepth levels, keys are
/// plain text and distinct, one document.
struct YamlNode {
  enum class Kind { kNull, kText, kSequence, kMap };

  Kind kind = Kind::kNull;
  int line = 0;
  std::string text;               ///< Of kText.
  std::vector<std::string> keys;  ///< Of kMap, one for each item.
  std::vector<YamlNode> items;    ///< Of kSequence and kMap, in the order of the file.

  /// The value of a key, or null.
  const YamlNode* Find(std::string_view key) const;
};

inline constexpr std::size_t kMaxYamlDepth = 16;

/// Larger documents are refused: the tree takes about ten times the memory of its text.
inline constexpr std::size_t kMaxYamlBytes = std::size_t{64} << 20;

/// Error: kParse, with file and line.
Expected<YamlNode> ParseYaml(const std::string& text, const std::string& file);

}  // namespace sextant
