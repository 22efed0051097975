// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "solvers/joint/board_view_residuals.h"

namespace sextant {

/// Boards are flat to millimetres, and so are the ranges on one of them to a few tenths: thousands
/// of returns would otherwise determine a common range offset b from the curvature of a face,
/// b u^2 / (2 d^2) at u from the middle and a distance of d, 1 mm on a board of 1.4 m for 60 mm.

/// The coefficients of a bend: height of the face over its plane a x^2 + b x y + c y^2, x and y in
/// half diagonals of the board.
inline constexpr Eigen::Index kBends = 3;
inline constexpr const char* kBendNames[kBends] = {"bend_xx_m", "bend_xy_m", "bend_yy_m"};
/// Standard deviation of each over that of a range offset: 2 mm for 10 mm.
inline constexpr double kBendOverRange = 0.2;

/// Derivative of the ranges of a view's face returns by the coefficients, one row for each.
Eigen::Matrix<double, Eigen::Dynamic, kBends> RangeByBend(const BoardViewTerms& terms,
                                                          const BoardPlane& plane,
                                                          double half_diagonal_m);

}  // namespace sextant
