// SPDX-License-Identifier: Apache-2.0
#include "io/output/remove_file.h"

#include <cerrno>

#include "io/output/file_mark.h"
#include "io/output/write_error.h"

namespace sextant {

Expected<void> CheckRemovable(const std::filesystem::path& path, Replace replace) {
  SEXTANT_ASSIGN_OR_RETURN(const OutputTarget target, FindTarget(path));
  return CheckReplaceable(target, replace);
}

Expected<void> RemoveFile(const std::filesystem::path& path, Replace replace) {
  SEXTANT_ASSIGN_OR_RETURN(const OutputTarget target, FindTarget(path));
  if (!target.existing) return {};
  SEXTANT_RETURN_IF_ERROR(CheckReplaceable(target, replace));
  const bool gone = unlinkat(target.folder.get(), target.name.c_str(), 0) == 0 || errno == ENOENT;
  if (!gone) return WriteError(path);
  return {};
}

bool RemoveOwnFile(const std::filesystem::path& path) {
  const Expected<OutputTarget> target = FindTarget(path);
  return target && target->existing &&
         OriginOf(target->folder.get(), target->name) == FileOrigin::kSextant &&
         unlinkat(target->folder.get(), target->name.c_str(), 0) == 0;
}

}  // namespace sextant
