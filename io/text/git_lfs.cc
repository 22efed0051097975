// SPDX-License-Identifier: Apache-2.0
#include "io/text/git_lfs.h"

namespace sextant {

Expected<void> RefuseGitLfsPointer(std::string_view bytes) {
  if (!bytes.starts_with("version https://git-lfs.github.com/spec/")) return {};
  return MakeError(
      ErrorCode::kParse,
      "this is a Git LFS pointer, not the file itself, which was not fetched; fetch it "
      "with git lfs pull");
}

}  // namespace sextant
