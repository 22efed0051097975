// SPDX-License-Identifier: Apache-2.0
#include "solvers/blocks/log_by_turn.h"

#include "geometry/so3.h"

namespace sextant {

Eigen::Matrix3d LogByTurn(const Eigen::Vector3d& phi) {
  const Eigen::Matrix3d hat = Hat(phi);
  return Eigen::Matrix3d::Identity() - 0.5 * hat + (1.0 / 12.0) * hat * hat;
}

}  // namespace sextant
