// SPDX-License-Identifier: Apache-2.0
#include "io/output/write_error.h"

#include <fmt/core.h>

#include <cerrno>
#include <system_error>

#include "base/text/path_text.h"
#include "io/text/number_text.h"

namespace sextant {

tl::unexpected<Error> WriteError(ErrorCode code, const std::filesystem::path& path,
                                 const std::string& reason) {
  return MakeError(code, fmt::format("cannot write '{}': {}", PathText(path), reason));
}

tl::unexpected<Error> WriteError(const std::filesystem::path& path) {
  return WriteError(ErrorCode::kUnwritable, path, std::generic_category().message(errno));
}

}  // namespace sextant
