// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace sextant {

/// The derivative of a cost by one parameter block, in the memory of Ceres.
using DerivativeBlock =
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

/// That by parameter block `index`, set to zero; without entries where Ceres does not need it.
DerivativeBlock ZeroDerivative(double** jacobians, std::size_t index, Eigen::Index rows,
                               Eigen::Index columns);

}  // namespace sextant
