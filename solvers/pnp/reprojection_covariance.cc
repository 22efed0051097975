// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/reprojection_covariance.h"

#include "geometry/residuals.h"
#include "geometry/symmetric.h"
#include "solvers/least_squares/term_derivatives.h"

namespace sextant {
namespace {

// Degrees of freedom of a pose.
constexpr double kPoseFreedom = 6.0;

// sum_i J_i^T J_i / sigma_i^2 over all projections, sigma_i = sigma_of(pair i). None where a point
// does not project.
template <class SigmaOf>
std::optional<Matrix6d> Information(const Camera& camera, std::span<const Pair2d3d> pairs,
                                    const Rigid3d& pose, const SigmaOf& sigma_of) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  Matrix6d information = Matrix6d::Zero();
  TermDerivatives<2> at;
  for (const Pair2d3d& pair : pairs) {
    const PixelTerm term = {pair.pixel, pair.point_in_lidar, 1.0 / sigma_of(pair)};
    if (!Differentiate(term, &camera, r, pose.translation, at)) return std::nullopt;
    const Eigen::Matrix<double, 2, 6> jacobian = at.Jacobian();
    information.noalias() += jacobian.transpose() * jacobian;
  }
  return information;
}

}  // namespace

std::optional<double> UnstatedVariance(const Camera& camera, std::span<const Pair2d3d> pairs,
                                       const Rigid3d& pose) {
  if (pairs.empty()) return std::nullopt;
  if (HasKnownNoise(pairs.front())) return 0.0;
  const double freedom = 2.0 * static_cast<double>(pairs.size()) - kPoseFreedom;
  if (freedom <= 0.0) return std::nullopt;
  double squares = 0.0;
  for (const Pair2d3d& pair : pairs) {
    const auto residual = ReprojectionResidual(camera, pose, pair);
    if (!residual) return std::nullopt;
    squares += residual->squaredNorm();
  }
  return squares / freedom;
}

std::optional<Matrix6d> ReprojectionCovariance(const Camera& camera,
                                               std::span<const Pair2d3d> pairs,
                                               const Rigid3d& pose) {
  const std::optional<double> unstated = UnstatedVariance(camera, pairs, pose);
  if (!unstated) return std::nullopt;
  // Unit variance where it is the same for all: that of exact data is zero and must not divide.
  const std::optional<Matrix6d> information =
      Information(camera, pairs, pose,
                  [](const Pair2d3d& pair) { return HasKnownNoise(pair) ? pair.sigma_px : 1.0; });
  if (!information) return std::nullopt;
  const std::optional<Matrix6d> inverse = InvertSymmetric(*information);
  if (!inverse) return std::nullopt;
  const double scale = HasKnownNoise(pairs.front()) ? 1.0 : *unstated;
  return Matrix6d(scale * *inverse);
}

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
  return Information(camera, pairs, pose, [](const Pair2d3d&) { return 1.0; });
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
  // Within the triple the residuals are zero, and the projected variance is one per coordinate.
  const double others = static_cast<double>(pairs.size()) - 3.0;
  const double expected = 2.0 * others + relative->cwiseProduct(*information).sum() - 6.0;
  return Matrix6d(squares / expected * *relative);
}

}  // namespace sextant
