// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace sextant {

/// Marks a file, before it is closed, as written by sextant: the attribute user.sextant holds its
/// size and the time of its last change. A file system without attributes stays without the mark.
void MarkAsWritten(int fd);

/// What the mark of a file states about it.
enum class FileOrigin {
  kSextant,   ///< sextant wrote it and nobody has changed it since; or it has no bytes to lose.
  kChanged,   ///< It was changed since sextant wrote it.
  kUnmarked,  ///< Copies lose the mark, unless made with `cp -a`.
  kUnknown,   ///< Its file system keeps no marks.
};

/// `folder`: an open folder; `name`: a file in it.
FileOrigin OriginOf(int folder, const std::string& name);

/// Whether the text is among the first 4096 bytes of the file, which is not kChanged: for pages
/// that state what wrote them.
bool StatesOrigin(int folder, const std::string& name, std::string_view text);

}  // namespace sextant
