// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibrate/match/assemble.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// An edge of a board as the scans show it, over all views.
struct MeasuredEdge {
  int board = 0;            ///< Index into the boards.
  int edge = 0;             ///< 0: from top to right; 1: from right to bottom.
  double stated_m = 0.0;    ///< In the board file.
  double measured_m = 0.0;  ///< Median over the views.
  double sigma_m = 0.0;     ///< Standard deviation of that median, from the scatter of the views.
  double Excess() const { return measured_m / stated_m - 1.0; }
};

/// By board, then edge; of the matched boards whose sides the scan shows.
std::vector<MeasuredEdge> MeasureEdges(std::span<const SessionView> views,
                                       const Assembly& assembly);

/// The beam's spot widens an outline by at most this share of the edge; nothing narrows one.
inline constexpr double kMaxBeamSpread = 0.035;

/// Whether the edge differs from the board file significantly (three sigmas and 1.5 percent), and
/// not as the beam widens it.
bool ContradictsFile(const MeasuredEdge& edge);

/// One line per board that the scans show in another size, with its cause: the beam, or the board
/// file. Empty where they agree.
std::vector<std::string> DescribeEdges(std::span<const MeasuredEdge> edges,
                                       const Assembly& assembly);

/// How well the camera model fits the printed corners; medians over the views.
struct PrintFit {
  double rms_px = 0.0;
  double over_noise = 0.0;  ///< RMS over the stated noise.
};
/// None where no print has redundant corners.
std::optional<PrintFit> MeasurePrints(std::span<const SessionView> views, const Assembly& assembly);

/// Median angle between the normals of the boards by the image and by the scan [rad].
std::optional<double> NormalsOff(const CalibrationProblem& problem, const Rigid3d& cam_from_lidar);

}  // namespace sextant
