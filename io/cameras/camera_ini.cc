// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "base/nearest_name.h"
#include "io/cameras/camera_file.h"
#include "io/cameras/camera_parts.h"
#include "io/text/line_reader.h"

namespace sextant {
namespace {

constexpr int kMaxIniPixels = 1'000'000;  // Per side.

int ReadSize(LineReader& in, const std::string& name) {
  if (!in.Require(name) || !in.HasFields(1, name)) return 0;
  return static_cast<int>(in.Integer(0, 0, kMaxIniPixels, name));
}

std::vector<double> ReadRows(LineReader& in, int rows, std::size_t cols, const std::string& name) {
  std::vector<double> values;
  for (int i = 0; i < rows; ++i) {
    const std::string what = fmt::format("row {} of {} of the {}", i + 1, rows, name);
    if (!in.Require(what) || !in.HasFields(cols, what)) break;
    for (std::size_t j = 0; j < cols; ++j) values.push_back(in.Real(j, name));
  }
  return values;
}

std::vector<double> ReadDistortion(LineReader& in) {
  std::vector<double> values;
  if (!in.Require("the distortion coefficients")) return values;
  for (std::size_t j = 0; j < in.field_count(); ++j) values.push_back(in.Real(j, "distortion"));
  return values;
}

// The words of the line, joined by single spaces.
std::string Heading(const LineReader& in) {
  std::string heading;
  for (std::size_t i = 0; i < in.field_count(); ++i) {
    if (i > 0) heading += ' ';
    heading += in.Field(i);
  }
  return heading;
}

}  // namespace

Expected<Camera> ParseCameraIni(std::string_view text, const std::string& file) {
  static const std::vector<std::string> kHeadings = {
      "width", "height", "camera matrix", "intrinsic", "distortion", "rectification", "projection"};
  LineReader in(file, text);
  CameraParts parts;
  std::vector<double> matrix;
  std::vector<double> distortion;
  while (in.Next()) {
    const std::string heading = Heading(in);
    if (heading.starts_with('[') && heading.ends_with(']')) continue;
    if (heading == "width") {
      parts.width_px = ReadSize(in, heading);
    } else if (heading == "height") {
      parts.height_px = ReadSize(in, heading);
    } else if (heading == "camera matrix" || heading == "intrinsic") {
      matrix = ReadRows(in, 3, 3, heading);
    } else if (heading == "distortion") {
      distortion = ReadDistortion(in);
    } else if (heading == "rectification") {
      ReadRows(in, 3, 3, heading);
    } else if (heading == "projection") {
      ReadRows(in, 3, 4, heading);
    } else {
      in.Fail(ErrorCode::kParse, fmt::format("unknown heading {}; {}", Quoted(heading),
                                             SuggestName(heading, kHeadings)));
    }
  }
  if (in.ok() && matrix.empty()) in.Require("the heading camera matrix");
  if (!in.ok()) return in.TakeError();
  std::copy(matrix.begin(), matrix.end(), parts.matrix.begin());
  parts.distortion = distortion;
  return AtPlace(CameraFromParts(parts), {.file = file});
}

}  // namespace sextant
