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

/// Decodes a PNG, JPEG, BMP, PBM/PGM/PPM, TIFF (not BigTIFF) or WebP. Errors: kParse if the bytes
/// are none of these, cut off, or state far more pixels than bytes (CheckImageExtent); kIo if
/// OpenCV's library of image formats cannot be loaded. Memory is linear in the pixels: 16.8
/// million, or 100 for each byte if that is more, of at most 12 bytes. Time is, too; a JPEG has up
/// to 200 passes over them.
Expected<cv::Mat> DecodeImage(std::string_view bytes, DecodedColor color);

/// Encodes an image in the format of a file name's extension (".png"). `jpeg_quality`: 0 to 100;
/// none: OpenCV's default. Errors: kInvalidOption for an unknown extension or an image that the
/// format cannot hold; kIo as above.
Expected<std::string> EncodeImage(const std::string& extension, const cv::Mat& image,
                                  std::optional<int> jpeg_quality = {});

}  // namespace sextant
