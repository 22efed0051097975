// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "base/error.h"

namespace sextant {

/// Checks a JPEG or PNG before it is decoded; bytes of another format pass.
///
/// OpenCV fills what is missing of a JPEG with grey and drops libjpeg's warning, so the markers
/// (ITU T.81, annex B) are followed to the end of the image; those of a thumbnail within a segment
/// do not count. In a PNG, each chunk must be whole, up to IEND.
///
/// Errors: kParse, with the byte, for an image that is cut off, and for one of more than 67 million
/// pixels that has less than a byte for each hundred. Time is linear in the bytes; no memory.
Expected<void> CheckImageExtent(std::string_view bytes);

}  // namespace sextant
