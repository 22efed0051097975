// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "calibrate/advise/advise.h"

namespace sextant {
namespace {

constexpr double kParallel_deg = 10.0;
constexpr double kOneDirection_deg = 10.0;
constexpr double kOneRange = 0.1;

std::string Sideways(double metres, const char* positive, const char* negative,
                     const char* nowhere) {
  if (std::abs(metres) < 0.05) return nowhere;
  return fmt::format("{:.1f} m {}", std::abs(metres), metres > 0.0 ? positive : negative);
}

// The largest angle between any two of the directions.
double SpreadOf(const std::vector<Eigen::Vector3d>& directions) {
  double largest = 0.0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const double cosine = std::clamp(directions[i].dot(directions[k]), -1.0, 1.0);
      largest = std::max(largest, std::acos(cosine));
    }
  }
  return largest / kRadPerDeg;
}

}  // namespace

std::string DescribePlacement(const Board& board, const Rigid3d& cam_from_board,
                              const PlacementObserver& observer) {
  const Eigen::Vector3d& t = cam_from_board.translation;
  const Eigen::Vector3d normal = cam_from_board.rotation * Eigen::Vector3d::UnitZ();
  // Angles of the normal, which points away from the camera: about the vertical, then leaning.
  const double turn_deg = std::atan2(normal.x(), normal.z()) / kRadPerDeg;
  const double lean_deg = -std::asin(std::clamp(normal.y(), -1.0, 1.0)) / kRadPerDeg;
  const std::string name = board.name.empty() ? fmt::format("board {}", board.id)
                                              : fmt::format("board {} ({})", board.id, board.name);
  std::string text =
      fmt::format("Hold {} {:.1f} m in front of {}, {} and {}{}", name, t.z(), observer.name,
                  Sideways(t.x(), "to its right", "to its left", "straight ahead"),
                  Sideways(t.y(), "below it", "above it", "at its height"),
                  observer.corner_up ? ", with one corner up" : "");
  if (std::abs(turn_deg) >= 5.0) {
    text += fmt::format(", turned so that its {} side is farther away by {:.0f} deg",
                        turn_deg > 0.0 ? "left" : "right", std::abs(turn_deg));
  }
  if (std::abs(lean_deg) >= 5.0) {
    text += fmt::format(", its top leaning {} by {:.0f} deg",
                        lean_deg > 0.0 ? "towards " + observer.name : "away from " + observer.name,
                        std::abs(lean_deg));
  }
  if (std::abs(turn_deg) < 5.0 && std::abs(lean_deg) < 5.0) {
    text += fmt::format(", facing {} squarely", observer.name);
  }
  return text + ".";
}

std::vector<std::string> DegenerateSets(const std::vector<Rigid3d>& cam_from_board) {
  std::vector<std::string> sets;
  if (cam_from_board.size() < 2) return sets;
  std::vector<Eigen::Vector3d> normals;
  std::vector<Eigen::Vector3d> directions;
  double nearest = 1e9;
  double farthest = 0.0;
  for (const Rigid3d& pose : cam_from_board) {
    normals.push_back(pose.rotation * Eigen::Vector3d::UnitZ());
    directions.push_back(pose.translation.normalized());
    nearest = std::min(nearest, pose.translation.norm());
    farthest = std::max(farthest, pose.translation.norm());
  }
  if (SpreadOf(normals) < kParallel_deg) {
    sets.push_back(fmt::format(
        "all boards are parallel to within {:.0f} deg: only their edges determine the translation "
        "along them; tilt them",
        SpreadOf(normals)));
  }
  if (farthest - nearest < kOneRange * farthest) {
    sets.push_back(fmt::format(
        "all boards are at one range, {:.1f} to {:.1f} m: errors of scale or intrinsics cannot be "
        "detected; hold some nearer and some farther away",
        nearest, farthest));
  }
  if (SpreadOf(directions) < kOneDirection_deg) {
    sets.push_back(fmt::format(
        "all boards are in one direction to within {:.0f} deg: rotation and translation are "
        "correlated; spread them over the image",
        SpreadOf(directions)));
  }
  return sets;
}

}  // namespace sextant
