// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace sextant {

/// Derivative of the logarithm of a rotation by a perturbation on its left, the inverse of
/// LeftJacobianSo3, to the fourth order in the angle, which is small at a minimum.
Eigen::Matrix3d LogByTurn(const Eigen::Vector3d& phi);

}  // namespace sextant
