// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <utility>

#include "base/units.h"
#include "eval/diagnostics/pair_diagnostics.h"

namespace sextant {
namespace {

constexpr std::array<const char*, kCornersPerBoard> kCornerNames = {"top", "right", "bottom",
                                                                    "left"};

std::string CornerName(int corner) {
  if (corner < 0 || corner >= kCornersPerBoard) return std::to_string(corner);
  return kCornerNames[static_cast<std::size_t>(corner)];
}

std::string Describe(const BoardContradiction& contradiction) {
  const double scale = contradiction.in_pixels ? 1.0 : 1e3;
  const char* unit = contradiction.in_pixels ? "px" : "mm";
  const std::string apart =
      contradiction.in_pixels
          ? std::string()
          : fmt::format(": a board is up to {:.0f} mm elsewhere by another one's pose",
                        1e3 * contradiction.apart_m);
  return fmt::format(
      "contradiction: the boards fit to RMSE {:.1f} {} one by one, but only to {:.1f} {} together "
      "under one pose{}. A board moved between the sensors' measurements, {}or its corners are in "
      "a "
      "wrong order; {}more boards or views must decide",
      scale * contradiction.rmse_alone, unit, scale * contradiction.rmse_together, unit, apart,
      contradiction.in_pixels ? "its corners have an error in common, " : "",
      contradiction.is_undecided ? "neither side outnumbers the other, so "
                                 : "a robust solver keeps some boards against the others, so ");
}

std::string Describe(const EdgeFinding& edge) {
  const std::string known =
      edge.known_m ? fmt::format(", nominal {:.3f} m", *edge.known_m) : std::string();
  return fmt::format(
      "edges: board {} of view {}, {} to {}: camera {:.3f} m, LiDAR {:.3f} m{}; one of its corners "
      "is off by about {:.0f} mm",
      edge.board, edge.view, CornerName(edge.edge), CornerName((edge.edge + 1) % kCornersPerBoard),
      edge.in_cam_m, edge.in_lidar_m, known,
      1e3 * std::max(std::abs(edge.in_cam_m - edge.in_lidar_m),
                     edge.known_m ? std::abs(edge.in_lidar_m - *edge.known_m) : 0.0));
}

std::string Describe(const WeakDirection& weak) {
  const double scale = weak.is_rotation ? 1.0 / kRadPerDeg : 1e3;
  return fmt::format(
      "weak: the {} {} ({:.2f}, {:.2f}, {:.2f}) in the camera frame is known to {:.3g} {}, the "
      "best direction to {:.3g}; spread the boards more widely across it",
      weak.is_rotation ? "rotation about" : "translation along", "axis", weak.axis_in_cam.x(),
      weak.axis_in_cam.y(), weak.axis_in_cam.z(), weak.sigma * scale,
      weak.is_rotation ? "deg" : "mm", weak.best_sigma * scale);
}

}  // namespace

std::vector<std::string> Describe(const PairDiagnostics& diagnostics,
                                  std::span<const RepeatedPairs> repeated) {
  std::vector<std::string> lines = diagnostics.causes;
  for (std::string& line : Describe(diagnostics.order, repeated)) {
    lines.push_back(std::move(line));
  }
  if (diagnostics.contradiction) lines.push_back(Describe(*diagnostics.contradiction));
  if (diagnostics.mirrored_rmse_m) {
    lines.push_back(fmt::format(
        "mirrored: a reflection would fit with RMSE {:.4f} m, less than half of what any rotation "
        "reaches; check the corners' order and the sign of the axes",
        *diagnostics.mirrored_rmse_m));
  }
  for (const EdgeFinding& edge : diagnostics.edges) lines.push_back(Describe(edge));
  if (diagnostics.weak_rotation) lines.push_back(Describe(*diagnostics.weak_rotation));
  if (diagnostics.weak_translation) lines.push_back(Describe(*diagnostics.weak_translation));
  return lines;
}

}  // namespace sextant
