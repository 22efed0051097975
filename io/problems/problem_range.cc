// SPDX-License-Identifier: Apache-2.0
#include "io/problems/problem_range.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <functional>
#include <string_view>

#include "geometry/coordinate_range.h"

namespace sextant {
namespace {

using PointOf = std::function<const Eigen::Vector3d&(std::size_t)>;

Expected<void> CheckPoints(std::string_view what, std::size_t count, const PointOf& point_of) {
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d& point = point_of(i);
    if (!((point.array().abs() <= kMaxCoordinate_m).all())) {
      return MakeError(
          ErrorCode::kInvalidInput,
          fmt::format(
              "{}: point {} of {}: expected coordinates up to {:g} m, got {:g} {:g} {:g}; are "
              "they in metres?",
              what, i + 1, count, kMaxCoordinate_m, point.x(), point.y(), point.z()));
    }
    box.extend(point);
  }
  const double extent = count == 0 ? 0.0 : box.sizes().maxCoeff();
  if (extent == 0.0 || extent >= kMinExtent_m) return {};
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("{}: all {} points are within {:g} m, expected {:g} m or more; are "
                               "they in metres?",
                               what, count, extent, kMinExtent_m));
}

Expected<void> CheckSigma(std::string_view what, std::size_t index, double sigma) {
  if (sigma == 0.0 || (sigma >= kMinSigma && sigma <= kMaxCoordinate_m)) return {};
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("{} {}: expected a sigma from {:g} to {:g}, or 0 for unknown, got "
                               "{:g}",
                               what, index + 1, kMinSigma, kMaxCoordinate_m, sigma));
}

Expected<void> CheckPairs(const CalibrationProblem& problem) {
  const auto& points = problem.pairs_3d3d;
  const auto& pixels = problem.pairs_2d3d;
  using Point = const Eigen::Vector3d&;
  SEXTANT_RETURN_IF_ERROR(
      CheckPoints("pairs, camera frame", points.size(),
                  [&](std::size_t i) -> Point { return points[i].point_in_cam; }));
  SEXTANT_RETURN_IF_ERROR(
      CheckPoints("pairs, LiDAR frame", points.size(),
                  [&](std::size_t i) -> Point { return points[i].point_in_lidar; }));
  SEXTANT_RETURN_IF_ERROR(
      CheckPoints("pairs with pixels, LiDAR frame", pixels.size(),
                  [&](std::size_t i) -> Point { return pixels[i].point_in_lidar; }));
  for (std::size_t i = 0; i < points.size(); ++i) {
    SEXTANT_RETURN_IF_ERROR(CheckSigma("3D-3D pair", i, points[i].sigma_m));
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    SEXTANT_RETURN_IF_ERROR(CheckSigma("2D-3D pair", i, pixels[i].sigma_px));
    if ((pixels[i].pixel.array().abs() <= kMaxCoordinate_m).all()) continue;
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("2D-3D pair {}: expected pixels up to {:g}, got {:g} {:g}", i + 1,
                                 kMaxCoordinate_m, pixels[i].pixel.x(), pixels[i].pixel.y()));
  }
  return {};
}

}  // namespace

Expected<void> CheckRange(const CalibrationProblem& problem) {
  SEXTANT_RETURN_IF_ERROR(CheckPairs(problem));
  using Point = const Eigen::Vector3d&;
  for (const auto& [points, what] :
       {std::pair{&problem.point_sets.in_cam, "point set, camera frame"},
        std::pair{&problem.point_sets.in_lidar, "point set, LiDAR frame"}}) {
    const auto& set = *points;
    SEXTANT_RETURN_IF_ERROR(
        CheckPoints(what, set.size(), [&set](std::size_t i) -> Point { return set[i]; }));
  }
  for (const BoardView& view : problem.board_views) {
    const auto& face = view.face_in_lidar;
    SEXTANT_RETURN_IF_ERROR(
        CheckPoints(fmt::format("returns of board {} in view {}", view.board, view.view),
                    face.size(), [&face](std::size_t i) -> Point { return face[i]; }));
  }
  return {};
}

}  // namespace sextant
