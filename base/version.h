// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace sextant {

/// "0.1.0": the version of the build, from the project's CMake.
std::string_view Version();

}  // namespace sextant
