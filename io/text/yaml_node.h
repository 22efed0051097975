// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

/// A YAML document as a plain tree with line numbers.
///
/// A deliberate subset of YAML, so that a hostile file costs no more than its size: no aliases (a
/// few lines of them can expand to billions of values) and no anchors, at most kMaxYamlDepth
/// levels, at most 256 keys in a map, which are plain text and distinct, one document. No text has
/// control characters (IsControl) but line feeds.
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

/// Larger documents are refused.
inline constexpr std::size_t kMaxYamlBytes = std::size_t{64} << 20;

/// Errors: kParse, with file and line; also for a document with too many values for its size.
/// Time is linear in the size, about 0.2 s per MB. Memory is at most 20 times the size and 64 MiB,
/// the program included. Documents with 15 bytes or more for each value are within this, at any
/// size, unless one collection in brackets exceeds 2 MB: problems and results as this program
/// writes them are read whole; JSON, which is one such collection, up to 2 MB.
Expected<YamlNode> ParseYaml(std::string_view text, const std::string& file);

}  // namespace sextant
