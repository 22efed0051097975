// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "base/error.h"

namespace sextant {

/// Checks an image before it is decoded: a JPEG, PNG, BMP, PBM/PGM/PPM, TIFF (not BigTIFF) or WebP.
///
/// OpenCV fills what is missing of a JPEG with grey and drops libjpeg's warning, so the markers
/// (ITU T.81, annex B) are followed to the end of the image; those of a thumbnail within a segment
/// do not count. In a PNG, each chunk must be whole, up to IEND.
///
/// Errors: kParse, with the byte, for a JPEG or PNG that is cut off; for another format, as the
/// memory that its decoder takes is not known; for an image of more than 16.8 million pixels
/// (2^24) that has less than a byte for each hundred; for a JPEG of more than 200 scans, each of
/// which is a pass over all pixels. Time is linear in the bytes; no memory.
Expected<void> CheckImageExtent(std::string_view bytes);

}  // namespace sextant
