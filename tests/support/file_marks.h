// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/xattr.h>

#include <filesystem>

#include "support/run_program.h"

namespace sextant::test {

/// Whether the file system of the folder keeps attributes of users, by which sextant recognises the
/// files that it wrote.
inline bool KeepsMarks(const std::filesystem::path& folder) {
  const std::filesystem::path probe = folder / "probe";
  WriteText(probe, "x");
  const bool keeps = setxattr(probe.c_str(), "user.probe", "1", 1, 0) == 0;
  std::filesystem::remove(probe);
  return keeps;
}

}  // namespace sextant::test
