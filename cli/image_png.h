// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "base/error.h"
#include "io/bag/messages.h"

namespace sextant::cli {

/// The image as a PNG file. Bayer mosaics and YUV are turned into colours, all else is kept to the
/// bit. Error: kInvalidInput for an encoding that is not known, or rows shorter than it needs.
Expected<std::string> EncodePng(const ImageMessage& image);

}  // namespace sextant::cli
