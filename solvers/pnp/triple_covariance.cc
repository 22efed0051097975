// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/triple_covariance.h"

#include "geometry/residuals.h"
#include "solvers/pnp/reprojection_covariance.h"

namespace sextant {

std::optional<Matrix6d> RelativeTripleCovariance(const Camera& camera,
                                                 std::span<const Pair2d3d> pairs,
                                                 const Triple& triple, const Rigid3d& pose) {
  std::array<Pair2d3d, 3> used = {pairs[triple[0]], pairs[triple[1]], pairs[triple[2]]};
  for (Pair2d3d& pair : used) {
    if (!HasKnownNoise(pair)) pair.sigma_px = 1.0;
  }
  return ReprojectionCovariance(camera, used, pose);
}

std::optional<Matrix6d> ProjectionInformation(const Camera& camera, std::span<const Pair2d3d> pairs,
                                              const Rigid3d& pose) {
  Matrix6d information = Matrix6d::Zero();
  for (const Pair2d3d& pair : pairs) {
    const auto jacobian = ReprojectionJacobian(camera, pose, pair);
    if (!jacobian) return std::nullopt;
    information.noalias() += jacobian->transpose() * *jacobian;
  }
  return information;
}

std::optional<Matrix6d> TripleCovariance(const Camera& camera, std::span<const Pair2d3d> pairs,
                                         const Triple& triple, const Rigid3d& pose) {
  std::optional<Matrix6d> relative = RelativeTripleCovariance(camera, pairs, triple, pose);
  if (!relative || HasKnownNoise(pairs.front())) return relative;
  if (pairs.size() == 3) return std::nullopt;
  double squares = 0.0;
  for (const Pair2d3d& pair : pairs) {
    const auto residual = ReprojectionResidual(camera, pose, pair);
    if (!residual) return std::nullopt;
    squares += residual->squaredNorm();
  }
  const std::optional<Matrix6d> information = ProjectionInformation(camera, pairs, pose);
  if (!information) return std::nullopt;
  // Within the triple the residuals are zero and the projected variance is one a coordinate.
  const double others = static_cast<double>(pairs.size()) - 3.0;
  const double expected = 2.0 * others + relative->cwiseProduct(*information).sum() - 6.0;
  return Matrix6d(squares / expected * *relative);
}

}  // namespace sextant
