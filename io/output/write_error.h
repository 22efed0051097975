// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "base/error.h"

namespace sextant {

/// "cannot write '<path>': <reason>".
tl::unexpected<Error> WriteError(ErrorCode code, const std::filesystem::path& path,
                                 const std::string& reason);

/// kUnwritable, with the reason in errno.
tl::unexpected<Error> WriteError(const std::filesystem::path& path);

}  // namespace sextant
