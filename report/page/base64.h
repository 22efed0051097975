// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace sextant {

/// The bytes in base 64 with padding (RFC 4648, section 4): four characters for three bytes.
std::string Base64(std::string_view bytes);

}  // namespace sextant
