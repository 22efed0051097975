// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "geometry/rigid3d.h"

namespace sextant {

/// What the views themselves show about the uncertainty of the answer.
struct ViewScatter {
  int views = 0;  ///< Independent ones.
  /// Sigma by the jackknife over the solver's, geometric mean over the axes.
  std::optional<double> jackknife_over_solver{};
  std::optional<Matrix6d> bootstrap{};  ///< Covariance of the bootstrap over views.
};

/// The covariance that is stated: the smallest one that keeps the solver's axes and is, in no
/// direction, below
///   - the solver's covariance, times the excess of the views' scatter where that is above 1: the
///     squared jackknife ratio times t(84 %, n - 1)^2 of Student's distribution, which makes up for
///     what a standard deviation from n views misses;
///   - the bootstrap's covariance, which knows the directions in which the views disagree.
/// With the solver's covariance L L^T it is L V max(excess, values) V^T L^T, where V and the values
/// are the eigenvectors and eigenvalues of the bootstrap's covariance, whitened by L.
/// Without the solver's: the bootstrap's times the same factor of t. None without either.
std::optional<Matrix6d> StatedCovariance(const std::optional<Matrix6d>& solver,
                                         const ViewScatter& scatter);

/// Student's t that as much lies below as below one standard deviation of a normal distribution.
/// Within 1 percent. One degree of freedom for fewer.
double OneSigmaOfT(int degrees);

/// The symmetric matrix T with T * from * T = to, for two symmetric positive definite matrices
/// (Bhatia 2007, their geometric mean). None where `from` is singular.
std::optional<Matrix6d> CongruenceTo(const Matrix6d& from, const Matrix6d& to);

}  // namespace sextant
