// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/simd.h"
#include "geometry/rigid3d.h"

namespace sextant {

inline constexpr std::size_t kMaxP3pPoses = 4;

/// Every pose that sees three points along three rays: R p_i + t = d_i y_i with depths d_i > 0.
///
/// Shapes: unit rays y_i in the camera frame; points p_i in the LiDAR frame [m]. Writes the poses
/// (camera from LiDAR) to the front of `poses` and returns how many there are, 0 to 4, in no
/// particular order. Allocates nothing.
///
/// Equations: the law of cosines (d_i - d_j)^2 + e_ij d_i d_j = |p_i - p_j|^2 with
/// e_ij = |y_i - y_j|^2, which keeps its digits for narrow angles where 2 - 2 cos does not.
/// Divided by d_3^2 and with the common scale eliminated they are two conics in (d_1, d_2) / d_3; a
/// degenerate conic of their pencil, from one real root of a cubic, is a pair of lines that meets
/// either conic in the solutions (Ding, Yang, Larsson, Olsson, Astrom 2023, "Revisiting the P3P
/// Problem", CVPR; Persson and Nordberg 2018, "Lambda Twist", ECCV, for the polish). Here the
/// unknowns are (d_1 / d_3 - 1, d_2 / d_3 - 1) divided by the widest angle, which are of order one
/// at any distance of the points. Newton steps on the three distances then refine each solution to
/// rounding.
///
/// Degenerate, with no pose: points within 1e-6 of their extent of a line, or three equal rays. On
/// the cylinder through the points and normal to their plane two solutions merge and lose half
/// their digits.
int SolveP3p(std::span<const Eigen::Vector3d, 3> rays_in_cam,
             std::span<const Eigen::Vector3d, 3> points_in_lidar,
             std::span<Rigid3d, kMaxP3pPoses> poses);

/// Eight triples, coordinate by coordinate: rays[3 * i + axis][k] belongs to ray i of triple k.
struct alignas(64) P3pTriples {
  double rays[9][kSimdWidth];
  double points[9][kSimdWidth];
};

/// Candidates of eight triples: candidate c of triple k is a pose where exists[c][k] is not zero.
struct alignas(64) P3pPoses {
  double rotation[kMaxP3pPoses][9][kSimdWidth];  ///< Row by row; orthonormal to 1e-9.
  double translation[kMaxP3pPoses][3][kSimdWidth];
  long long exists[kMaxP3pPoses][kSimdWidth];

  Rigid3d Pose(std::size_t candidate, std::size_t triple) const;
};

/// SolveP3p of eight triples at once: the same poses, in a fifth of the time.
void SolveP3pBatch(const P3pTriples& triples, P3pPoses& poses);

}  // namespace sextant
