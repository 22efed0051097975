// SPDX-License-Identifier: Apache-2.0
#include "io/problems/points_file.h"

#include <fmt/core.h>

#include <iterator>
#include <vector>

#include "io/text/line_reader.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

std::vector<Eigen::Vector3d> ReadRows(LineReader& in, std::int64_t count, const char* sensor) {
  // The count may be wrong, so memory grows with the rows that are read.
  std::vector<Eigen::Vector3d> points;
  for (std::int64_t i = 0; i < count && in.ok(); ++i) {
    const auto what = [&] {
      return fmt::format("x y z of {} point {} of {} (m)", sensor, i + 1, count);
    };
    if (!in.Next()) {
      in.Require(what());
      break;
    }
    if (in.field_count() != 3 && !in.HasFields(3, what())) break;
    Eigen::Vector3d& point = points.emplace_back();
    for (int k = 0; k < 3; ++k) point[k] = in.Real(static_cast<std::size_t>(k));
  }
  return points;
}

}  // namespace

Expected<CalibrationProblem> ReadPoints(const std::filesystem::path& path) {
  return ReadWith(path, ParsePoints);
}

Expected<CalibrationProblem> ParsePoints(std::string_view text, const std::string& file) {
  constexpr std::int64_t kMaxPoints = 1'000'000'000'000'000;
  LineReader in(file, text);
  std::int64_t count = 0;
  if (in.Require("the number of points") && in.HasFields(1, "the number of points alone")) {
    count = in.Integer(0, 1, kMaxPoints, "number of points");
  }
  const std::vector<Eigen::Vector3d> in_lidar = ReadRows(in, count, "LiDAR");
  const std::vector<Eigen::Vector3d> in_cam = ReadRows(in, count, "camera");
  if (in.Next()) {
    in.Fail(ErrorCode::kParse,
            fmt::format("expected the end of the file after 2 x {} points, got {}", count,
                        Quoted(in.Field(0))));
  }
  if (!in.ok()) return in.TakeError();

  CalibrationProblem problem;
  for (std::size_t i = 0; i < in_cam.size(); ++i) {
    const int n = static_cast<int>(i);
    Pair3d3d& pair = problem.pairs_3d3d.emplace_back();
    pair.point_in_cam = in_cam[i];
    pair.point_in_lidar = in_lidar[i];
    pair.id = {.view = 0, .board = n / kCornersPerBoard, .corner = n % kCornersPerBoard};
  }
  problem.point_sets = WithholdPairing(problem.pairs_3d3d);
  return problem;
}

std::string FormatPoints(std::span<const Pair3d3d> pairs) {
  std::string text = fmt::format("{}\n", pairs.size());
  const auto append = [&text](const Eigen::Vector3d& p) {
    fmt::format_to(std::back_inserter(text), "{} {} {}\n", p.x(), p.y(), p.z());
  };
  for (const Pair3d3d& pair : pairs) append(pair.point_in_lidar);
  for (const Pair3d3d& pair : pairs) append(pair.point_in_cam);
  return text;
}

}  // namespace sextant
