// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "base/error.h"
#include "io/bag/messages.h"

namespace sextant {

/// Converts an image message to an OpenCV image. Bayer mosaics and YUV become BGR, other encodings
/// are kept bit by bit. Error: kInvalidInput for an unknown encoding, for rows shorter than it
/// needs, and for bytes that are neither PNG nor JPEG.
Expected<cv::Mat> ToMat(const ImageMessage& image);
Expected<cv::Mat> ToMat(const EncodedImageMessage& image);

/// The bytes of a PNG file with the same image.
Expected<std::string> EncodePng(const ImageMessage& image);

}  // namespace sextant
