// SPDX-License-Identifier: Apache-2.0
#include "io/output/output_target.h"

#include <fcntl.h>
#include <fmt/core.h>

#include <cerrno>
#include <system_error>

#include "base/text/path_text.h"
#include "io/output/file_mark.h"
#include "io/output/write_error.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> Refused(const fs::path& path, const std::string& reason) {
  return WriteError(ErrorCode::kInvalidOption, path, reason);
}

tl::unexpected<Error> RefusedLink(const fs::path& path) {
  std::error_code ignored;
  const std::string end = fs::read_symlink(path, ignored).string();
  return Refused(path,
                 fmt::format("it is a link to '{}'; name that file itself, or remove the link",
                             PathText(end)));
}

Expected<void> CheckWritable(const OutputTarget& target) {
  // The owner of the system may write everything, so the permissions are looked at too.
  if ((target.existing->st_mode & 0222U) == 0) {
    return WriteError(ErrorCode::kUnwritable, target.path,
                      "it is read-only; allow writing with chmod u+w, or name another file");
  }
  if (faccessat(target.folder.get(), target.name.c_str(), W_OK, AT_EACCESS) != 0) {
    return WriteError(target.path);
  }
  return {};
}

// Sets what is at the target: nothing, a regular file, or a stream.
Expected<void> Examine(OutputTarget& target) {
  struct stat status {};
  const int folder = target.folder.get();
  const char* const name = target.name.c_str();
  if (fstatat(folder, name, &status, AT_SYMLINK_NOFOLLOW) != 0) {
    return errno == ENOENT ? Expected<void>() : WriteError(target.path);
  }
  const bool is_link = S_ISLNK(status.st_mode);
  if (is_link && fstatat(folder, name, &status, 0) != 0) return RefusedLink(target.path);
  if (S_ISDIR(status.st_mode)) return Refused(target.path, "it is a folder, expected a file");
  if (S_ISBLK(status.st_mode)) return Refused(target.path, "it is a disk, expected a file");
  target.is_stream = !S_ISREG(status.st_mode);
  if (target.is_stream) return {};
  if (is_link) return RefusedLink(target.path);
  target.existing = status;
  target.id = IdOf(status);
  return CheckWritable(target);
}

std::string_view WhyForeign(FileOrigin origin) {
  switch (origin) {
    case FileOrigin::kChanged:
      return "it was changed since sextant wrote it";
    case FileOrigin::kUnknown:
      return "it exists, and its file system keeps no attributes, by which sextant knows the files "
             "that it wrote";
    default:
      return "it exists, and sextant did not write it, or it is a copy";
  }
}

}  // namespace

Expected<OutputTarget> FindTarget(const fs::path& path) {
  OutputTarget target{.path = path};
  if (path.empty()) return Refused(path, "expected the name of a file, got an empty text");
  target.name = path.filename().string();
  if (target.name.empty()) return Refused(path, "it names a folder, expected a file");
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  target.folder = Descriptor(open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  struct stat status {};
  if (!target.folder.is_open() || fstat(target.folder.get(), &status) != 0) return WriteError(path);
  target.id = {status.st_dev, status.st_ino, target.name};
  SEXTANT_RETURN_IF_ERROR(Examine(target));
  return target;
}

Expected<void> CheckReplaceable(const OutputTarget& target, Replace replace) {
  CallFiles* const call = CallFiles::Current();
  if (call == nullptr || call->may_overwrite() || replace == Replace::kAnyFile) return {};
  if (!target.existing) return {};
  const FileOrigin origin = OriginOf(target.folder.get(), target.name);
  const bool is_lost = origin == FileOrigin::kUnmarked || origin == FileOrigin::kUnknown;
  if (origin == FileOrigin::kSextant || (is_lost && call->IsRecognised(target.id))) return {};
  return Refused(target.path, fmt::format("{}; --overwrite replaces it", WhyForeign(origin)));
}

bool IsPageOf(const fs::path& path, std::string_view text) {
  const Expected<OutputTarget> target = FindTarget(path);
  return target && target->existing && StatesOrigin(target->folder.get(), target->name, text);
}

Expected<void> ClaimOutput(const fs::path& path, OutputUse use) {
  SEXTANT_ASSIGN_OR_RETURN(const OutputTarget target, FindTarget(path));
  if (target.is_stream) return {};
  if (faccessat(target.folder.get(), ".", W_OK | X_OK, AT_EACCESS) != 0) return WriteError(path);
  CallFiles* const call = CallFiles::Current();
  if (call == nullptr) return {};
  if (const std::string why = call->ClaimOutput(target.id, use); !why.empty()) {
    return Refused(path, why);
  }
  return use.may_be_read ? Expected<void>() : CheckReplaceable(target, Replace::kOwnFiles);
}

}  // namespace sextant
