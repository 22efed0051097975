// SPDX-License-Identifier: Apache-2.0
#include "io/images/image_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace sextant {
namespace {

using testing::HasSubstr;

cv::Mat Gradient(int type) {
  cv::Mat image(20, 30, type);
  for (int row = 0; row < image.rows; ++row) {
    image.row(row).setTo(cv::Scalar(10.0 * row, 5.0 * row, 3.0 * row));
  }
  return image;
}

int DifferingValues(const cv::Mat& a, const cv::Mat& b) {
  EXPECT_EQ(a.type(), b.type());
  EXPECT_EQ(a.size(), b.size());
  if (a.size() != b.size() || a.type() != b.type()) return -1;
  const cv::Mat differs = a != b;
  return cv::countNonZero(differs.reshape(1));
}

TEST(ImageCodec, PngIsLosslessForEveryDepth) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
    const cv::Mat image = Gradient(type);
    const Expected<std::string> bytes = EncodeImage(".png", image);
    ASSERT_TRUE(bytes) << bytes.error().message;
    const Expected<cv::Mat> decoded = DecodeImage(*bytes, DecodedColor::kUnchanged);
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(DifferingValues(image, *decoded), 0) << type;
  }
}

TEST(ImageCodec, ConvertsColors) {
  const Expected<std::string> bytes = EncodeImage(".png", Gradient(CV_8UC3));
  ASSERT_TRUE(bytes) << bytes.error().message;
  EXPECT_EQ(DecodeImage(*bytes, DecodedColor::kGrey)->type(), CV_8UC1);
  EXPECT_EQ(DecodeImage(*bytes, DecodedColor::kBgr)->type(), CV_8UC3);
}

TEST(ImageCodec, JpegIsClose) {
  const cv::Mat image = Gradient(CV_8UC1);
  const Expected<std::string> bytes = EncodeImage(".jpg", image);
  ASSERT_TRUE(bytes) << bytes.error().message;
  const Expected<cv::Mat> decoded = DecodeImage(*bytes, DecodedColor::kGrey);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_LT(cv::norm(image, *decoded, cv::NORM_INF), 8.0);
}

// OpenCV fills what is missing of a JPEG with grey.
TEST(ImageCodec, EveryTruncationOfAnImageIsRefused) {
  cv::Mat noise(40, 50, CV_8UC3);
  cv::randu(noise, 0, 255);
  for (const char* extension : {".png", ".jpg"}) {
    const std::string bytes = EncodeImage(extension, noise).value();
    ASSERT_TRUE(DecodeImage(bytes, DecodedColor::kUnchanged));
    EXPECT_TRUE(DecodeImage(bytes + "appended", DecodedColor::kUnchanged)) << extension;
    for (std::size_t size = 4; size < bytes.size(); ++size) {
      const Expected<cv::Mat> cut = DecodeImage(bytes.substr(0, size), DecodedColor::kUnchanged);
      ASSERT_FALSE(cut) << extension << " " << size;
      EXPECT_THAT(cut.error().message, HasSubstr("cut off: it ends at byte")) << size;
    }
  }
}

// The thumbnail in an Exif segment has an end marker of its own.
TEST(ImageCodec, AnEndMarkerWithinASegmentIsNotTheEnd) {
  const std::string bytes = EncodeImage(".jpg", Gradient(CV_8UC1)).value();
  const std::string segment("\xff\xe1\x00\x06\xff\xd8\xff\xd9", 8);
  const std::string with_thumbnail = bytes.substr(0, 2) + segment + bytes.substr(2);
  EXPECT_TRUE(DecodeImage(with_thumbnail, DecodedColor::kGrey));
  EXPECT_FALSE(DecodeImage(with_thumbnail.substr(0, bytes.size() - 10), DecodedColor::kGrey));
}

// A camera that was held sideways states it in an Exif segment; pixels are those of the upright
// image, as every viewer shows it.
TEST(ImageCodec, TheExifOrientationIsApplied) {
  const std::string bytes = EncodeImage(".jpg", Gradient(CV_8UC1)).value();
  const std::string exif(
      "\xff\xe1\x00\x22"
      "Exif\0\0II\x2a\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0",
      36);
  const std::string turned = bytes.substr(0, 2) + exif + bytes.substr(2);
  for (const DecodedColor color :
       {DecodedColor::kUnchanged, DecodedColor::kBgr, DecodedColor::kGrey}) {
    const cv::Mat plain = DecodeImage(bytes, color).value();
    const cv::Mat upright = DecodeImage(turned, color).value();
    EXPECT_EQ(upright.cols, plain.rows);
    EXPECT_EQ(upright.rows, plain.cols);
  }
}

TEST(ImageCodec, EveryFormatOfCamerasIsRead) {
  for (const std::string extension : {".png", ".jpg", ".bmp", ".pgm", ".ppm", ".tiff", ".webp"}) {
    const int type = extension == ".pgm" ? CV_8UC1 : CV_8UC3;
    const Expected<std::string> bytes = EncodeImage(extension, Gradient(type));
    ASSERT_TRUE(bytes) << extension << ": " << bytes.error().message;
    const Expected<cv::Mat> decoded = DecodeImage(*bytes, DecodedColor::kGrey);
    ASSERT_TRUE(decoded) << extension << ": " << decoded.error().message;
    EXPECT_EQ(decoded->size(), cv::Size(30, 20)) << extension;
  }
}

// The bytes of an image of 30 x 20 pixels with some of them replaced.
std::string Altered(const char* extension, std::size_t at, std::string_view bytes) {
  std::string image = EncodeImage(extension, Gradient(CV_8UC1)).value();
  return image.replace(at, bytes.size(), bytes);
}

// Where a TIFF of low bytes first states the width, a number of 16 bits.
std::size_t WidthOfTiff(std::string_view tiff) {
  using std::string_view_literals::operator""sv;
  const auto directory = static_cast<std::size_t>(static_cast<unsigned char>(tiff[4])) +
                         256 * static_cast<std::size_t>(static_cast<unsigned char>(tiff[5]));
  return tiff.find("\x00\x01\x03\x00\x01"sv, directory);
}

TEST(ImageCodec, FewBytesThatStateManyPixelsAreRefused) {
  using std::string_literals::operator""s;
  const std::string tiff = EncodeImage(".tiff", Gradient(CV_8UC1)).value();
  const std::string jpeg = EncodeImage(".jpg", Gradient(CV_8UC1)).value();
  const std::size_t frame = jpeg.find("\xff\xc0");
  const struct {
    std::string bytes, size;
  } cases[] = {
      {Altered(".png", 16, "\x01"), "16777246 x 20"},
      {Altered(".jpg", frame + 5, "\x7f\xff\x7f\xff"), "32767 x 32767"},
      {Altered(".bmp", 18, "\x1e\0\0\x10"s), "268435486 x 20"},
      // Rows from top to bottom.
      {Altered(".bmp", 22, "\x9c\xff\xff\x8f"), "30 x 1879048292"},
      {"P5 # comment 7\n 30000\n30000 255\n", "30000 x 30000"},
      {Altered(".tiff", WidthOfTiff(tiff) + 2, "\x04\0\x01\0\0\0\xff\xff\xff\x0f"s),
       "268435455 x 20"},
      {"RIFF\x1a\0\0\0WEBPVP8L\x0d\0\0\0\x2f\xff\xff\xff\x0f\0\0\0\0\0\0\0\0"s, "16384 x 16384"},
      {"RIFF\x1a\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\xff\xff\xff\xff\0\0"s, "16777216 x 256"},
      {"RIFF\x1a\0\0\0WEBPVP8 \x0d\0\0\0\0\0\0\x9d\x01\x2a\xff\x3f\xff\x3f\0\0"s, "16383 x 16383"},
  };
  for (const auto& [bytes, size] : cases) {
    const Expected<cv::Mat> decoded = DecodeImage(bytes, DecodedColor::kGrey);
    ASSERT_FALSE(decoded) << size;
    EXPECT_THAT(decoded.error().message, HasSubstr("states " + size + " pixels"));
  }
}

// Each scan of a progressive JPEG is a pass over all pixels.
TEST(ImageCodec, AJpegOfManyScansIsRefused) {
  const std::string bytes = EncodeImage(".jpg", Gradient(CV_8UC1)).value();
  const std::size_t scan = bytes.find("\xff\xda");
  std::string many = bytes.substr(0, bytes.size() - 2);
  for (int i = 0; i < 200; ++i) many += bytes.substr(scan, bytes.size() - 2 - scan);
  EXPECT_THAT(DecodeImage(many + "\xff\xd9", DecodedColor::kGrey).error().message,
              HasSubstr("more than 200 scans"));
}

TEST(ImageCodec, WhatIsNoImageIsAnError) {
  for (const char* text : {"", "this is not an image", "\x89PNG", "BM", "P5", "P5 30", "II\x2a",
                           "RIFF0000WEBPVP8 ", "#?RADIANCE\n\n-Y 99999 +X 99999\n"}) {
    const Expected<cv::Mat> decoded = DecodeImage(text, DecodedColor::kUnchanged);
    ASSERT_FALSE(decoded) << text;
    EXPECT_EQ(decoded.error().code, ErrorCode::kParse);
    EXPECT_THAT(decoded.error().message, HasSubstr("expected an image"));
  }
  for (const char* extension : {".nothing", "", "png"}) {
    const Expected<std::string> bytes = EncodeImage(extension, Gradient(CV_8UC1));
    ASSERT_FALSE(bytes) << extension;
    EXPECT_EQ(bytes.error().code, ErrorCode::kInvalidOption);
  }
}

}  // namespace
}  // namespace sextant
