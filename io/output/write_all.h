// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace sextant {

/// Writes all bytes at the file's position. False, with errno, if it cannot.
bool WriteAll(int fd, std::string_view bytes);

}  // namespace sextant
