// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

#include "base/error.h"

namespace sextant {

/// Reads an image in any format of OpenCV as grey or BGR of 8 or 16 bits, rotated by its Exif
/// orientation. Errors: kIo (no such file, or one that cannot be read), kParse (not an image, or
/// one whose end is missing). Time and memory: those of DecodeImage.
Expected<cv::Mat> ReadImage(const std::filesystem::path& path);

/// The same, converted to BGR of 8 bits.
Expected<cv::Mat> ReadColourImage(const std::filesystem::path& path);

/// Whether WriteImage knows the format that the extension names; to be called before long work.
/// Error: kInvalidOption.
Expected<void> CheckImageName(const std::filesystem::path& path);

/// Writes the format that the extension names, atomically. Errors: kInvalidOption for an extension
/// without an image format; kIo.
Expected<void> WriteImage(const cv::Mat& image, const std::filesystem::path& path);

}  // namespace sextant
