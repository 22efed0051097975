// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "base/error.h"

namespace sextant::cli {

/// The bytes of a PNG file. Error: kIo, with OpenCV's reason.
Expected<std::string> EncodePng(const cv::Mat& image);

}  // namespace sextant::cli
