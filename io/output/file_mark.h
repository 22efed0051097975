// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace sextant {

/// Marks a file, before it is closed, as written by sextant: the attribute user.sextant holds its
/// size and the time of its last change. A file system without attributes stays without the mark.
void MarkAsWritten(int fd);

/// Whether sextant wrote the file and nobody has changed it since. Copies lose the mark, unless
/// made with `cp -a`. A file of no bytes holds nothing to lose and counts as written.
/// `folder`: an open folder; `name`: a file in it.
bool IsWrittenBySextant(int folder, const std::string& name);

}  // namespace sextant
