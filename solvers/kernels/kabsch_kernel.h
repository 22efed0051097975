// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/kernels/kabsch.h"
#include "solvers/kernels/kabsch_moments.h"

namespace sextant {

/// What FitKabsch and FitKabschBatch share besides their formulas.

struct KernelFit {
  Vector4<double> q;
  Point3<double> translation;
  double trace = 0.0;
  double mirrored_trace = 0.0;
};

/// Where the formula cannot prove itself; false where the points do not determine a rotation.
bool FitByEigensolver(const CentredMoments<double>& moments, KernelFit& fit);

/// The fit, or kMirrored; `squares` is that of the moments.
KabschOutcome CheckFit(const KernelFit& kernel, double squares);

}  // namespace sextant
