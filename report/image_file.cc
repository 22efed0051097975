// SPDX-License-Identifier: Apache-2.0
#include "report/image_file.h"

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

namespace sextant::cli {

Expected<std::string> EncodePng(const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  try {
    if (cv::imencode(".png", image, bytes)) return std::string(bytes.begin(), bytes.end());
  } catch (const cv::Exception& error) {
    return MakeError(ErrorCode::kIo, "cannot encode an image as PNG: " + error.err);
  }
  return MakeError(ErrorCode::kIo, "cannot encode an image as PNG");
}

}  // namespace sextant::cli
