// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/photo_file.h"

#include <fmt/core.h>

#include "io/images/image_codec.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

Expected<cv::Mat> ReadAs(const std::filesystem::path& path, DecodedColor color) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string bytes, ReadTextFile(path));
  Expected<cv::Mat> image = DecodeImage(bytes, color);
  if (image) return image;
  return MakeError(image.error().code, fmt::format("{}: {}", path.string(), image.error().message));
}

}  // namespace

Expected<cv::Mat> ReadImage(const std::filesystem::path& path) {
  return ReadAs(path, DecodedColor::kUnchanged);
}

Expected<cv::Mat> ReadColourImage(const std::filesystem::path& path) {
  return ReadAs(path, DecodedColor::kBgr);
}

Expected<void> WriteImage(const cv::Mat& image, const std::filesystem::path& path) {
  const Expected<std::string> bytes = EncodeImage(path.extension().string(), image);
  if (bytes) return WriteFileAtomically(path, *bytes);
  if (bytes.error().code == ErrorCode::kIo) return tl::unexpected<Error>(bytes.error());
  return MakeError(ErrorCode::kInvalidOption,
                   path.string() + ": expected an image that ends in .png or .jpg");
}

}  // namespace sextant
