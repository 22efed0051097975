// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/max_trace_rotation.h"

#include "geometry/symmetric.h"
#include "solvers/kernels/trace_formula.h"

namespace sextant {
namespace {

// Where points are within 1e-5 of their length of a line, rounding decides the rotation about it.
constexpr double kMinRelativeGap = 1e-10;

SEXTANT_MULTIVERSION bool ByFormula(const CrossMatrix<double>& cross, double bound,
                                    TraceMaximum& best) {
  const std::optional<TraceMaximum> found = MaximizeTraceByFormula(cross, bound);
  if (found) best = *found;
  return found.has_value();
}

}  // namespace

std::optional<MaxTraceRotation> MaximizeTraceByEigensolver(const CrossMatrix<double>& cross,
                                                           double bound) {
  const HornMatrix<double> h = MakeHornMatrix(cross);
  Eigen::Matrix4d k;
  k << h.xx, h.xy, h.xz, h.xw, h.xy, h.yy, h.yz, h.yw, h.xz, h.yz, h.zz, h.zw, h.xw, h.yw, h.zw,
      h.ww;
  const SymmetricEigen<4> eigen = EigenOf(k);
  const Eigen::Vector4d& lambda = eigen.values;
  if (!(lambda(3) - lambda(2) > kMinRelativeGap * bound)) return std::nullopt;
  return MaxTraceRotation{Eigen::Quaterniond(eigen.vectors.col(3)).normalized(), lambda(3),
                          -lambda(0)};
}

std::optional<MaxTraceRotation> MaximizeTrace(const Eigen::Matrix3d& cross, double trace_bound) {
  const CrossMatrix<double> m = {cross(0, 0), cross(0, 1), cross(0, 2), cross(1, 0), cross(1, 1),
                                 cross(1, 2), cross(2, 0), cross(2, 1), cross(2, 2)};
  TraceMaximum best;
  if (!ByFormula(m, trace_bound, best)) return MaximizeTraceByEigensolver(m, trace_bound);
  return MaxTraceRotation{ToQuaternion(best.q), best.trace, best.mirrored_trace};
}

}  // namespace sextant
