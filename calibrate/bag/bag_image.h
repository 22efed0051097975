// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "base/error.h"
#include "io/bag/messages.h"

namespace sextant {

/// The image as OpenCV has it. Bayer mosaics and YUV are turned into colours (BGR), all else is
/// kept to the bit. Error: kInvalidInput for an encoding that is not known, rows shorter than it
/// needs, and bytes that are no PNG or JPEG.
Expected<cv::Mat> ToMat(const ImageMessage& image);
Expected<cv::Mat> ToMat(const EncodedImageMessage& image);

/// The same as a PNG file.
Expected<std::string> EncodePng(const ImageMessage& image);

}  // namespace sextant
