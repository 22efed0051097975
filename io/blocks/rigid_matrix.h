// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/rigid3d.h"

namespace sextant {

/// Whether |R R^T - I| < tolerance (Frobenius) and det R > 0.
bool IsRotation(const Eigen::Matrix3d& matrix, double tolerance);

/// The transform of a 4x4 matrix as printed in a file; none unless it is a rotation to 1e-5 and a
/// translation of at most kMaxCoordinate_m above the row 0 0 0 1.
std::optional<Rigid3d> RigidFromMatrix(const Eigen::Matrix4d& matrix);

}  // namespace sextant
