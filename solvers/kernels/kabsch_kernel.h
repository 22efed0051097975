// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/kernels/kabsch.h"
#include "solvers/kernels/kabsch_moments.h"

namespace sextant {

/// The result of the formula, before the check for mirrored points.
struct KernelFit {
  Vector4<double> q;
  Point3<double> translation;
  double trace = 0.0;
  double mirrored_trace = 0.0;
};

/// Used where the residual does not prove the result of the formula. False where the points do not
/// determine a rotation.
bool FitByEigensolver(const CentredMoments<double>& moments, KernelFit& fit);

/// The fit, or kMirrored. `squares` is CentredMoments::squares.
KabschOutcome CheckFit(const KernelFit& kernel, double squares);

}  // namespace sextant
