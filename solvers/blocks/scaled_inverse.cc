// SPDX-License-Identifier: Apache-2.0
#include "solvers/blocks/scaled_inverse.h"

#include <cmath>

#include "geometry/symmetric.h"

namespace sextant {

Eigen::MatrixXd ScaledInverse(const Eigen::MatrixXd& information) {
  constexpr double kSmallestEigenvalue = 1e-14;
  const Eigen::VectorXd scale =
      information.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; });
  const auto eigen = EigenOf<Eigen::Dynamic>(scale.asDiagonal() * information * scale.asDiagonal());
  const Eigen::VectorXd inverse =
      eigen.values.unaryExpr([](double e) { return e > kSmallestEigenvalue ? 1.0 / e : 0.0; });
  const Eigen::MatrixXd vectors = scale.asDiagonal() * eigen.vectors;
  return vectors * inverse.asDiagonal() * vectors.transpose();
}

}  // namespace sextant
