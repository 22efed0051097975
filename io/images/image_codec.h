// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"

namespace sextant {

/// How pixels are converted when an image is decoded.
enum class DecodedColor {
  kUnchanged,  ///< Channels without alpha, and bits per channel, as in the file.
  kBgr,        ///< Three channels of 8 bits.
  kGrey,       ///< One channel of 8 bits.
};

/// Decodes an image in any format that OpenCV reads. Errors: kParse if the bytes are no image, or a
/// JPEG or PNG that is cut off or far larger than its bytes (CheckImageExtent); kIo if OpenCV's
/// library of image formats cannot be loaded. Time and memory are linear in the pixels: 67 million,
/// or 100 for each byte if that is more, of at most 6 bytes; OpenCV's limit, 2^30 pixels, is that
/// of other formats than JPEG and PNG.
Expected<cv::Mat> DecodeImage(std::string_view bytes, DecodedColor color);

/// Encodes an image in the format of a file name's extension (".png"). `jpeg_quality`: 0 to 100;
/// none: OpenCV's default. Errors: kInvalidOption for an unknown extension or an image that the
/// format cannot hold; kIo as above.
Expected<std::string> EncodeImage(const std::string& extension, const cv::Mat& image,
                                  std::optional<int> jpeg_quality = {});

}  // namespace sextant
