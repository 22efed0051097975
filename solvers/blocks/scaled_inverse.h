// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace sextant {

/// The pseudo-inverse of a symmetric positive semi-definite matrix after scaling to a unit
/// diagonal: 0 along directions without information (eigenvalues up to 1e-14). O(n^3).
Eigen::MatrixXd ScaledInverse(const Eigen::MatrixXd& information);

}  // namespace sextant
