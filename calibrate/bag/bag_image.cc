// SPDX-License-Identifier: Apache-2.0
#include "calibrate/bag/bag_image.h"

#include <fmt/core.h>

#include <array>
#include <bit>
#include <opencv2/imgproc.hpp>
#include <string_view>
#include <vector>

#include "io/images/image_codec.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

constexpr int kAsItIs = -1;

struct Encoding {
  std::string_view name;
  int type = CV_8UC1;
  int to_bgr = kAsItIs;
  int rows_of_two = 2;  // Rows of samples for two rows of pixels.
};

// sensor_msgs/image_encodings. OpenCV names a mosaic by its second row's second and third pixel.
constexpr std::array kEncodings = {
    Encoding{"mono8", CV_8UC1},
    Encoding{"8UC1", CV_8UC1},
    Encoding{"mono16", CV_16UC1},
    Encoding{"16UC1", CV_16UC1},
    Encoding{"bgr8", CV_8UC3},
    Encoding{"8UC3", CV_8UC3},
    Encoding{"rgb8", CV_8UC3, cv::COLOR_RGB2BGR},
    Encoding{"bgra8", CV_8UC4},
    Encoding{"rgba8", CV_8UC4, cv::COLOR_RGBA2BGRA},
    Encoding{"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2BGR},
    Encoding{"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2BGR},
    Encoding{"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2BGR},
    Encoding{"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2BGR},
    Encoding{"bayer_rggb16", CV_16UC1, cv::COLOR_BayerBG2BGR},
    Encoding{"bayer_bggr16", CV_16UC1, cv::COLOR_BayerRG2BGR},
    Encoding{"bayer_gbrg16", CV_16UC1, cv::COLOR_BayerGR2BGR},
    Encoding{"bayer_grbg16", CV_16UC1, cv::COLOR_BayerGB2BGR},
    Encoding{"bgr16", CV_16UC3},
    Encoding{"rgb16", CV_16UC3, cv::COLOR_RGB2BGR},
    Encoding{"nv12", CV_8UC1, cv::COLOR_YUV2BGR_NV12, 3},
    Encoding{"nv21", CV_8UC1, cv::COLOR_YUV2BGR_NV21, 3},
    Encoding{"yuv422", CV_8UC2, cv::COLOR_YUV2BGR_UYVY},
    Encoding{"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2BGR_YUY2},
};

tl::unexpected<Error> Refuse(const std::string& what) {
  return MakeError(ErrorCode::kInvalidInput, what);
}

std::string KnownNames() {
  std::string names;
  for (const Encoding& encoding : kEncodings) {
    names += fmt::format("{}{}", names.empty() ? "" : ", ", encoding.name);
  }
  return names;
}

void SwapBytes(cv::Mat& image) {
  for (int row = 0; row < image.rows; ++row) {
    auto* pixel = image.ptr<std::uint16_t>(row);
    for (int i = 0; i < image.cols * image.channels(); ++i) {
      pixel[i] = static_cast<std::uint16_t>((pixel[i] << 8U) | (pixel[i] >> 8U));
    }
  }
}

}  // namespace

Expected<cv::Mat> ToMat(const ImageMessage& image) {
  const Encoding* found = nullptr;
  for (const Encoding& encoding : kEncodings) {
    if (encoding.name == image.encoding) found = &encoding;
  }
  if (found == nullptr) {
    return Refuse(fmt::format("unknown encoding {}, expected one of {}", Quoted(image.encoding),
                              KnownNames()));
  }
  const std::size_t needed = static_cast<std::size_t>(image.width_px) *
                             static_cast<std::size_t>(CV_ELEM_SIZE(found->type));
  if (image.width_px == 0 || image.height_px == 0 || image.row_bytes < needed) {
    return Refuse(fmt::format("expected rows of {} bytes or more for {} pixels of {}, got {}",
                              needed, image.width_px, image.encoding, image.row_bytes));
  }
  try {
    std::string data = image.data;  // OpenCV takes a pointer to writable data only.
    const int rows = image.height_px * found->rows_of_two / 2;
    cv::Mat pixels =
        cv::Mat(rows, image.width_px, found->type, data.data(), image.row_bytes).clone();
    if (CV_MAT_DEPTH(found->type) == CV_16U &&
        image.big_endian != (std::endian::native == std::endian::big)) {
      SwapBytes(pixels);
    }
    if (found->to_bgr != kAsItIs) cv::cvtColor(pixels, pixels, found->to_bgr);
    return pixels;
  } catch (const cv::Exception& error) {
    return Refuse(fmt::format("OpenCV cannot convert it: {}", Printable(error.err, 100)));
  }
}

Expected<cv::Mat> ToMat(const EncodedImageMessage& image) {
  Expected<cv::Mat> pixels = DecodeImage(image.data, DecodedColor::kUnchanged);
  if (pixels) return pixels;
  return Refuse(Printable(pixels.error().message, 120));
}

Expected<std::string> EncodePng(const ImageMessage& image) {
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat pixels, ToMat(image));
  Expected<std::string> png = EncodeImage(".png", pixels);
  if (png) return png;
  return Refuse(Printable(png.error().message, 120));
}

}  // namespace sextant
