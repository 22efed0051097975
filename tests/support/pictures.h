// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

#include "io/images/image_codec.h"
#include "support/run_program.h"

namespace sextant::test {

/// As cv::imread; empty if there is no image. Tests link no image formats, so that each process
/// starts fast; see io/images.
inline cv::Mat ReadPicture(const std::filesystem::path& path,
                           DecodedColor color = DecodedColor::kBgr) {
  return DecodeImage(ReadText(path), color).value_or(cv::Mat());
}

/// As cv::imwrite.
inline bool WritePicture(const std::filesystem::path& path, const cv::Mat& image) {
  const Expected<std::string> bytes = EncodeImage(path.extension().string(), image);
  if (bytes) WriteText(path, *bytes);
  return bytes.has_value();
}

}  // namespace sextant::test
