// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "features/lidar/board_finder.h"

namespace sextant {

/// The paper's checks of one board's corners.
struct CornerChecks {
  std::vector<int> points_per_edge{};    ///< For the sides 0 to 3, then 4 to 7 of the opening.
  std::vector<double> edge_lengths_m{};  ///< Distances of neighbouring corners.
  /// Distance of the two edge lines that meet at corner i; 0 for lines in one plane.
  std::vector<double> line_gaps_m{};
  double plane_sigma_m = 0.0;
};

/// Corners of one board in the LiDAR frame, numbered as in Board: 4, or 8 for a hollow board.
struct LidarCorners {
  int board = 0;  ///< Index into the boards of the search.
  std::vector<Eigen::Vector3d> in_lidar{};
  /// Joint covariance [m^2] of all corners, 3n x 3n: they share the board's plane and edges.
  Eigen::MatrixXd covariance{};
  CornerChecks checks{};

  Eigen::Matrix3d CovarianceOf(int corner) const {
    return covariance.block<3, 3>(3 * corner, 3 * corner);
  }
};

struct CornerExtractorInfo {
  const char* name;
  const char* summary;
};

/// lines3d, lines3d_raw, plane_lines, rectangle.
const std::vector<CornerExtractorInfo>& CornerExtractors();

/// Extracts the corners of a board that was found, by the extractor of that name:
/// - `lines3d` (Dhall et al. 2017): for each side the 3D line with the largest consensus (0.01 m)
///   among the last returns, refitted to its inliers; a corner is the middle of the shortest
///   segment between two neighbouring lines. Uses neither the plane nor the size.
/// - `lines3d_raw`: the same without refitting, as in the original package.
/// - `plane_lines`: lines in the board's plane by robust least squares, intersected.
/// - `rectangle`: the rectangle of known size fitted to the edge points in the plane.
/// Errors: kUnknownName; kTooFewPairs if a side has fewer than two edge points (all but rectangle),
/// with the numbers found and needed; kDegenerate if neighbouring lines are parallel.
Expected<LidarCorners> ExtractCorners(std::string_view extractor, const BoardPatch& patch,
                                      const Board& board);

}  // namespace sextant
