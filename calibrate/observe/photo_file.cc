// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/photo_file.h"

#include <fmt/core.h>

#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <vector>

#include "io/text/text_file.h"

namespace sextant {
namespace {

using namespace std::string_view_literals;

// The first and last bytes of an image format. Other bytes may follow the last ones.
struct Signature {
  std::string_view begin;
  std::string_view end;
};
constexpr Signature kEnds[] = {{"\xFF\xD8\xFF"sv, "\xFF\xD9"sv}, {"\x89PNG"sv, "IEND"sv}};
constexpr std::size_t kTailBytes = 4096;

bool IsTruncated(std::string_view bytes) {
  const std::string_view tail =
      bytes.substr(bytes.size() > kTailBytes ? bytes.size() - kTailBytes : 0);
  for (const Signature& ends : kEnds) {
    if (bytes.starts_with(ends.begin)) return tail.find(ends.end) == std::string_view::npos;
  }
  return false;
}

Expected<cv::Mat> ReadAs(const std::filesystem::path& path, int mode) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string bytes, ReadTextFile(path));
  if (IsTruncated(bytes)) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: the image is cut off: its end is missing", path.string()));
  }
  cv::Mat image;
  try {
    const std::vector<unsigned char> raw(bytes.begin(), bytes.end());
    if (!raw.empty()) image = cv::imdecode(raw, mode);
  } catch (const cv::Exception& error) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: expected an image: {}", path.string(), error.err));
  }
  if (image.empty()) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: expected an image, such as PNG or JPEG", path.string()));
  }
  return image;
}

}  // namespace

Expected<cv::Mat> ReadImage(const std::filesystem::path& path) {
  return ReadAs(path, cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR);
}

Expected<cv::Mat> ReadColourImage(const std::filesystem::path& path) {
  return ReadAs(path, cv::IMREAD_COLOR);
}

Expected<void> WriteImage(const cv::Mat& image, const std::filesystem::path& path) {
  std::vector<unsigned char> bytes;
  bool encoded = false;
  try {
    encoded = cv::imencode(path.extension().string(), image, bytes);
  } catch (const cv::Exception&) {
    encoded = false;
  }
  if (!encoded) {
    return MakeError(ErrorCode::kInvalidOption,
                     path.string() + ": expected an image that ends in .png or .jpg");
  }
  return WriteFileAtomically(path, std::string(bytes.begin(), bytes.end()));
}

}  // namespace sextant
