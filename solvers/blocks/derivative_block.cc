// SPDX-License-Identifier: Apache-2.0
#include "solvers/blocks/derivative_block.h"

namespace sextant {

DerivativeBlock ZeroDerivative(double** jacobians, std::size_t index, Eigen::Index rows,
                               Eigen::Index columns) {
  const bool needed = jacobians != nullptr && jacobians[index] != nullptr;
  DerivativeBlock block(needed ? jacobians[index] : nullptr, needed ? rows : 0,
                        needed ? columns : 0);
  block.setZero();
  return block;
}

}  // namespace sextant
