// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/photo_file.h"

#include <fmt/core.h>

#include "io/images/image_codec.h"
#include "io/output/output_file.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

Expected<cv::Mat> ReadAs(const std::filesystem::path& path, DecodedColor color) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string bytes, ReadTextFile(path));
  Expected<cv::Mat> image = DecodeImage(bytes, color);
  if (image) return image;
  return MakeError(image.error().code, fmt::format("{}: {}", path.string(), image.error().message));
}

Expected<std::string> EncodedFor(const std::filesystem::path& path, const cv::Mat& image) {
  Expected<std::string> bytes = EncodeImage(path.extension().string(), image);
  if (bytes || bytes.error().code == ErrorCode::kIo) return bytes;
  return MakeError(ErrorCode::kInvalidOption,
                   path.string() + ": expected an image that ends in .png or .jpg");
}

}  // namespace

Expected<cv::Mat> ReadImage(const std::filesystem::path& path) {
  return ReadAs(path, DecodedColor::kUnchanged);
}

Expected<cv::Mat> ReadColourImage(const std::filesystem::path& path) {
  return ReadAs(path, DecodedColor::kBgr);
}

Expected<void> CheckImageName(const std::filesystem::path& path) {
  SEXTANT_RETURN_IF_ERROR(EncodedFor(path, cv::Mat::zeros(1, 1, CV_8UC3)));
  return {};
}

Expected<void> WriteImage(const cv::Mat& image, const std::filesystem::path& path) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string bytes, EncodedFor(path, image));
  return WriteFileAtomically(path, bytes);
}

}  // namespace sextant
