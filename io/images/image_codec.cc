// SPDX-License-Identifier: Apache-2.0
#include "io/images/image_codec.h"

#include <dlfcn.h>
#include <fmt/core.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "io/images/image_extent.h"

namespace sextant {
namespace {

using Decode = cv::Mat (*)(cv::InputArray, int);
using Encode = bool (*)(const cv::String&, cv::InputArray, std::vector<unsigned char>&,
                        const std::vector<int>&);

struct ImageFormats {
  Decode decode = nullptr;
  Encode encode = nullptr;
  std::string error{};  ///< Why the functions could not be loaded; else empty.
};

#ifdef SEXTANT_IMAGE_FORMATS
// See CMakeLists.txt for the reason.
ImageFormats LoadImageFormats() {
  ImageFormats formats;
  // The library stays open until the process ends.
  void* const library = dlopen(SEXTANT_IMAGE_FORMATS, RTLD_NOW | RTLD_LOCAL);
  if (library != nullptr) {
    formats.decode =
        reinterpret_cast<Decode>(dlsym(library, "_ZN2cv8imdecodeERKNS_11_InputArrayEi"));
    formats.encode = reinterpret_cast<Encode>(
        dlsym(library,
              "_ZN2cv8imencodeERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKNS_"
              "11_InputArrayERSt6vectorIhSaIhEERKSB_IiSaIiEE"));
  }
  if (formats.decode == nullptr || formats.encode == nullptr) {
    const char* const reason = dlerror();
    formats.error = reason != nullptr ? reason : "a function is missing";
  }
  return formats;
}
#else
ImageFormats LoadImageFormats() {
  return {.decode = [](cv::InputArray bytes, int mode) { return cv::imdecode(bytes, mode); },
          .encode =
              [](const cv::String& extension, cv::InputArray image,
                 std::vector<unsigned char>& bytes, const std::vector<int>& parameters) {
                return cv::imencode(extension, image, bytes, parameters);
              }};
}
#endif

Expected<const ImageFormats*> LoadedFormats() {
  static const ImageFormats formats = LoadImageFormats();
  if (formats.error.empty()) return &formats;
  return MakeError(ErrorCode::kIo,
                   fmt::format("cannot load OpenCV's image formats: {}", formats.error));
}

int ReadMode(DecodedColor color) {
  if (color == DecodedColor::kBgr) return cv::IMREAD_COLOR;
  if (color == DecodedColor::kGrey) return cv::IMREAD_GRAYSCALE;
  return cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR;
}

}  // namespace

Expected<cv::Mat> DecodeImage(std::string_view bytes, DecodedColor color) {
  SEXTANT_RETURN_IF_ERROR(CheckImageExtent(bytes));
  SEXTANT_ASSIGN_OR_RETURN(const ImageFormats* const formats, LoadedFormats());
  cv::Mat image;
  try {
    const std::vector<unsigned char> raw(bytes.begin(), bytes.end());
    if (!raw.empty()) image = formats->decode(raw, ReadMode(color));
  } catch (const cv::Exception& error) {
    return MakeError(ErrorCode::kParse, "expected an image: " + error.err);
  }
  if (!image.empty()) return image;
  return MakeError(ErrorCode::kParse, "expected an image, such as PNG or JPEG");
}

Expected<std::string> EncodeImage(const std::string& extension, const cv::Mat& image,
                                  std::optional<int> jpeg_quality) {
  SEXTANT_ASSIGN_OR_RETURN(const ImageFormats* const formats, LoadedFormats());
  std::vector<int> parameters;
  if (jpeg_quality) parameters = {cv::IMWRITE_JPEG_QUALITY, *jpeg_quality};
  std::string reason = "no such format";
  try {
    std::vector<unsigned char> bytes;
    if (formats->encode(extension, image, bytes, parameters)) {
      return std::string(bytes.begin(), bytes.end());
    }
  } catch (const cv::Exception& error) {
    reason = error.err;
  }
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("cannot encode an image as '{}': {}", extension, reason));
}

}  // namespace sextant
