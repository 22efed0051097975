// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

#include "base/error.h"

namespace sextant {

/// The image of a file in any format of OpenCV, grey or BGR of 8 or 16 bits; turned as its Exif
/// orientation says. Errors: kIo (no such file, or one that cannot be read), kParse (not an image,
/// or one whose end is missing, which OpenCV would fill with grey).
Expected<cv::Mat> ReadImage(const std::filesystem::path& path);

/// The same as BGR of 8 bits, whatever it is.
Expected<cv::Mat> ReadColourImage(const std::filesystem::path& path);

/// Writes by the extension, whole or not at all. Errors: kInvalidOption for an extension that is no
/// image's; kIo.
Expected<void> WriteImage(const cv::Mat& image, const std::filesystem::path& path);

}  // namespace sextant
