// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "solvers/kernels/pair_terms.h"

namespace sextant {

/// Judges poses by the squared whitened residuals of pairs of one kind; refers to `terms`, which
/// must live as long. A point that does not project has an infinite residual.
class PoseScorer {
 public:
  /// `max_squared`: squared residual [sigma^2] up to which a pair is an inlier.
  PoseScorer(const PairTerms& terms, double max_squared)
      : terms_(&terms), max_squared_(max_squared) {}

  double max_squared() const { return max_squared_; }

  /// MSAC cost sum_i min(r_i^2, max_squared) (Torr and Zisserman 2000), or any number >= `give_up`
  /// as soon as the sum has reached it.
  double Cost(const Rigid3d& cam_from_lidar,
              double give_up = std::numeric_limits<double>::infinity()) const;

  /// r_i^2 of every pair. Shape: squared has the size of the terms.
  void SquaredResiduals(const Rigid3d& cam_from_lidar, std::span<double> squared) const;

  /// Indices, ascending, of the pairs with r_i^2 <= widening * max_squared. Allocates nothing once
  /// `inliers` has held all pairs.
  void Inliers(const Rigid3d& cam_from_lidar, std::vector<int>& inliers,
               double widening = 1.0) const;

 private:
  template <class Visit>
  void ForEach(const Rigid3d& cam_from_lidar, Visit&& visit) const;

  const PairTerms* terms_;
  double max_squared_;
};

}  // namespace sextant
