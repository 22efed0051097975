// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "geometry/rigid3d.h"

namespace sextant {

/// How a board moves about its place, in its own frame: what its constant velocity, and half of its
/// constant acceleration, add within kMotionUnit_s, as two poses. After the time t = s
/// kMotionUnit_s it is turned by s phi_1 + s^2 phi_2 (a rotation vector) and moved by s t_1 +
/// s^2 t_2.
using RigMotion = std::array<Rigid3d, 2>;
inline constexpr double kMotionUnit_s = 0.1;

/// Standard deviations of the priors of a motion: 2 rad/s and 1 m/s, 2 rad/s^2 and 1 m/s^2, as a
/// board that is carried or swung by hand has.
struct MotionSigma {
  double turn_rad = 0.0;
  double shift_m = 0.0;
};
inline constexpr std::array<MotionSigma, 2> kMotionSigmas = {
    {{2.0 * kMotionUnit_s, 1.0 * kMotionUnit_s},
     {0.5 * 2.0 * kMotionUnit_s * kMotionUnit_s, 0.5 * 1.0 * kMotionUnit_s* kMotionUnit_s}}};

/// board_from_moved after a time, with the derivatives of its (dphi, dt) by that of both poses of
/// the motion and by the time [1/s].
struct MovedBoard {
  Rigid3d board_from_moved;
  std::array<Matrix6d, 2> by_motion{};
  Vector6d by_time = Vector6d::Zero();
};
MovedBoard MovedAfter(const RigMotion& motion, double time_s);

/// The motion with constant velocity that leads from one pose of a board to another, both in one
/// frame, within `time_s`, which is not 0.
RigMotion MotionBetween(const Rigid3d& before, const Rigid3d& after, double time_s);

}  // namespace sextant
