// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/rig_motion.h"

#include <Eigen/Geometry>

#include "geometry/so3.h"
#include "solvers/blocks/log_by_turn.h"

namespace sextant {

MovedBoard MovedAfter(const RigMotion& motion, double time_s) {
  const double s = time_s / kMotionUnit_s;
  const std::array<double, 2> powers = {s, s * s};
  const std::array<double, 2> slopes = {1.0 / kMotionUnit_s, 2.0 * s / kMotionUnit_s};
  Eigen::Vector3d phi = Eigen::Vector3d::Zero();
  Vector6d by_time = Vector6d::Zero();
  MovedBoard moved;
  std::array<Eigen::Vector3d, 2> turns;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    turns[k] = LogSo3(motion[k].rotation);
    phi += powers[k] * turns[k];
    by_time.head<3>() += slopes[k] * turns[k];
    by_time.tail<3>() += slopes[k] * motion[k].translation;
    moved.board_from_moved.translation += powers[k] * motion[k].translation;
  }
  moved.board_from_moved.rotation = ExpSo3(phi);
  const Eigen::Matrix3d by_phi = LeftJacobianSo3(phi);
  by_time.head<3>() = (by_phi * by_time.head<3>()).eval();
  moved.by_time = by_time;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    moved.by_motion[k] = powers[k] * Matrix6d::Identity();
    moved.by_motion[k].topLeftCorner<3, 3>() = powers[k] * by_phi * LogByTurn(turns[k]);
  }
  return moved;
}

RigMotion MotionBetween(const Rigid3d& before, const Rigid3d& after, double time_s) {
  const double share = kMotionUnit_s / time_s;
  const Rigid3d step = before.Inverse() * after;
  RigMotion motion;
  motion[0].rotation = ExpSo3(share * LogSo3(step.rotation));
  motion[0].translation = share * step.translation;
  return motion;
}

}  // namespace sextant
