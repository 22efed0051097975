// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/rigid3d.h"

namespace sextant {

/// A measured transform and the covariance of its (dphi [rad], dt [m]); see Perturb.
struct UncertainPose {
  Rigid3d b_from_a{};
  Matrix6d covariance = Matrix6d::Zero();
};

/// Derivatives of b_from_c = b_from_a * a_from_c by perturbations of its factors, to first order.
struct ProductJacobians {
  Matrix6d by_left = Matrix6d::Identity();
  Matrix6d by_right = Matrix6d::Identity();
};
ProductJacobians JacobiansOfProduct(const Rigid3d& b_from_a, const Rigid3d& a_from_c);

/// Derivative of a_from_b by a perturbation of b_from_a, to first order.
Matrix6d JacobianOfInverse(const Rigid3d& b_from_a);

/// c_from_b * b_from_a of independent measurements, its covariance to first order.
UncertainPose Chain(const UncertainPose& c_from_b, const UncertainPose& b_from_a);

UncertainPose Inverse(const UncertainPose& b_from_a);

}  // namespace sextant
