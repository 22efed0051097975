// SPDX-License-Identifier: Apache-2.0
#include "io/boards/marker_files.h"

#include <fmt/core.h>

#include <algorithm>

#include "io/text/line_reader.h"
#include "io/text/max_id.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

constexpr double kMetresPerCm = 1e-2;

// Reads "(u,v)".
Eigen::Vector2d ReadPixel(LineReader& in, std::string_view text, std::size_t field) {
  const std::size_t comma = text.find(',');
  if (!text.starts_with('(') || !text.ends_with(')') || comma == std::string_view::npos) {
    in.Fail(ErrorCode::kParse, fmt::format("expected a corner (u,v), got {}", Quoted(text)));
    return Eigen::Vector2d::Zero();
  }
  const double u = in.RealOf(text.substr(1, comma - 1), field, "u");
  const double v = in.RealOf(text.substr(comma + 1, text.size() - comma - 2), field, "v");
  return {u, v};
}

// Reads "Txyz=x y z", where `name` is "Txyz=".
Eigen::Vector3d ReadVector(LineReader& in, std::string_view name, std::size_t field) {
  const std::string_view text = in.Field(field);
  if (!text.starts_with(name)) {
    in.Fail(ErrorCode::kParse, fmt::format("expected {}x y z, got {}", name, Quoted(text)));
    return Eigen::Vector3d::Zero();
  }
  const double x = in.RealOf(text.substr(name.size()), field, "x");
  const double y = in.Real(field + 1, "y");
  const double z = in.Real(field + 2, "z");
  return {x, y, z};
}

DetectedMarker ReadMarker(LineReader& in) {
  DetectedMarker marker;
  if (!in.HasFields(10, "id=(u,v) (u,v) (u,v) (u,v) Txyz=x y z Rxyz=x y z")) return marker;
  const std::string_view first = in.Field(0);
  const std::size_t equals = std::min(first.find('='), first.size() - 1);
  marker.id = static_cast<int>(in.IntegerOf(first.substr(0, equals), 0, 0, kMaxId, "id"));
  marker.corners_px[0] = ReadPixel(in, first.substr(equals + 1), 0);
  for (std::size_t i = 1; i < 4; ++i) marker.corners_px[i] = ReadPixel(in, in.Field(i), i);
  marker.translation_m = ReadVector(in, "Txyz=", 4);
  marker.rotation_rad = ReadVector(in, "Rxyz=", 7);
  return marker;
}

double ReadLength(LineReader& in, const char* name) {
  if (!in.Require(name) || !in.HasFields(1, name)) return 0.0;
  const double length_cm = in.Real(0, name);
  if (length_cm < 0.0) in.Fail(ErrorCode::kParse, fmt::format("expected {} >= 0 cm", name));
  return kMetresPerCm * length_cm;
}

}  // namespace

Expected<std::vector<MarkerBoard>> ReadMarkerCoordinates(const std::filesystem::path& path) {
  return ReadWith(path, ParseMarkerCoordinates);
}

Expected<std::vector<MarkerBoard>> ParseMarkerCoordinates(std::string_view text,
                                                          const std::string& file) {
  LineReader in(file, text);
  std::int64_t count = 0;
  if (in.Require("the number of boards") && in.HasFields(1, "the number of boards alone")) {
    count = in.Integer(0, 1, kMaxBoards, "number of boards");
  }
  std::vector<MarkerBoard> boards;
  for (std::int64_t i = 0; i < count && in.ok(); ++i) {
    MarkerBoard& board = boards.emplace_back();
    board.side1_m = ReadLength(in, "s1");
    board.side2_m = ReadLength(in, "s2");
    board.border1_m = ReadLength(in, "b1");
    board.border2_m = ReadLength(in, "b2");
    board.marker_m = ReadLength(in, "e");
  }
  if (in.Next()) {
    in.Fail(ErrorCode::kParse, fmt::format("expected the end of the file after {} boards", count));
  }
  if (!in.ok()) return in.TakeError();
  return boards;
}

std::vector<Board> BoardsOf(const std::vector<MarkerBoard>& markers) {
  std::vector<Board> boards;
  for (const MarkerBoard& marker : markers) {
    boards.push_back({.id = static_cast<int>(boards.size()),
                      .top_right_m = marker.side2_m,
                      .right_bottom_m = marker.side1_m});
  }
  return boards;
}

Expected<std::vector<DetectedMarker>> ReadDetectedMarkers(const std::filesystem::path& path) {
  return ReadWith(path, ParseDetectedMarkers);
}

Expected<std::vector<DetectedMarker>> ParseDetectedMarkers(std::string_view text,
                                                           const std::string& file) {
  LineReader in(file, text);
  std::vector<DetectedMarker> markers;
  in.Require("a marker, id=(u,v) ...");
  while (in.ok()) {
    markers.push_back(ReadMarker(in));
    if (!in.Next()) break;
  }
  if (!in.ok()) return in.TakeError();
  return markers;
}

}  // namespace sextant
