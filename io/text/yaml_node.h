// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

/// A YAML document as a plain tree with line numbers.
///
/// A deliberate subset of YAML, so that reading a hostile file costs no more than its size: no
/// aliases (a few lines of them can expand to billions of values), at most kMaxYamlDepth levels,
/// keys that are plain text and distinct, one document. No text has control characters (IsControl)
/// but line feeds.
struct YamlNode {
  enum class Kind { kNull, kText, kSequence, kMap };

  Kind kind = Kind::kNull;
  int line = 0;
  std::string text;               ///< For kText.
  std::vector<std::string> keys;  ///< For kMap, one for each item.
  std::vector<YamlNode> items;    ///< For kSequence and kMap, in the order of the file.

  /// The value of a key; null if there is none.
  const YamlNode* Find(std::string_view key) const;
};

inline constexpr std::size_t kMaxYamlDepth = 16;

/// Larger documents are refused: the tree takes about ten times as much memory as its text.
inline constexpr std::size_t kMaxYamlBytes = std::size_t{64} << 20;

/// Error: kParse, with file and line.
Expected<YamlNode> ParseYaml(const std::string& text, const std::string& file);

}  // namespace sextant
