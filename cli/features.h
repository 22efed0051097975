// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace sextant::cli {

/// What --version prints: the version alone on the first line, then what this build has and lacks.
std::string VersionText();

}  // namespace sextant::cli
