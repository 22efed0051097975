// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sextant {

/// Coordinates beyond these are refused where they are read: squares of larger ones, and quotients
/// of smaller ones, could overflow in a solver, and no sensor measures them.
inline constexpr double kMaxCoordinate_m = 1e9;
/// The smallest extent of a set of different points.
inline constexpr double kMinExtent_m = 1e-9;
/// The smallest standard deviation that is stated, in metres or pixels; 0 states none.
inline constexpr double kMinSigma = 1e-12;

}  // namespace sextant
