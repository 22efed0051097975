// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/calibration_problem.h"
#include "geometry/rigid3d.h"
#include "solvers/kernels/bit_graph.h"
#include "solvers/kernels/gnc_columns.h"
#include "solvers/kernels/pair_terms.h"
#include "solvers/least_squares/refine_pose.h"

namespace sextant {

/// Scores poses by the pairs of one kind of a problem: the scoring interface of the robust solvers.
/// r_i is the whitened residual of pair i, in sigmas; a pair is an inlier of a pose where
/// r_i^2 <= max_squared. A call scores a whole pose, so that no call is virtual per pair. Not
/// thread-safe: the buffers are kept between calls.
class PairScorer {
 public:
  virtual ~PairScorer() = default;
  PairScorer(const PairScorer&) = delete;
  PairScorer& operator=(const PairScorer&) = delete;

  PairKind kind() const { return kind_; }
  std::size_t size() const { return size_; }

  /// MSAC cost sum_i min(r_i^2, max_squared) (Torr and Zisserman 2000).
  double Cost(const Rigid3d& pose, double max_squared) const {
    return CostUpTo(pose, max_squared, std::numeric_limits<double>::infinity());
  }
  /// The cost, or any number >= `give_up` as soon as the sum has reached it.
  virtual double CostUpTo(const Rigid3d& pose, double max_squared, double give_up) const = 0;

  /// Writes the indices of the inliers, ascending. Allocates nothing once `inliers` has held all
  /// pairs.
  virtual void Inliers(const Rigid3d& pose, double max_squared,
                       std::vector<int>& inliers) const = 0;

  /// Writes r_i^2 of every pair. Shape: `squared` has as many numbers as there are pairs.
  virtual void SquaredResiduals(const Rigid3d& pose, std::span<double> squared) const = 0;

  /// Least squares on the inliers of `pose`; none where they do not determine a pose. `limits` are
  /// for iterative methods, which start at `pose`.
  virtual std::optional<Rigid3d> FitInliers(const Rigid3d& pose, double max_squared,
                                            const RefineLimits& limits) = 0;

  /// The probability that a random pair is an inlier of a given pose: the volume within the
  /// threshold over that of the measurements' bounding box (RandomPointProbability).
  virtual double RandomAgreementProbability(double max_squared) const = 0;

  /// The number of pairs at `indices` that differ from each other in their measurements.
  virtual int CountDistinct(std::span<const int> indices) const = 0;

  /// Residual terms of the pairs at `indices`.
  virtual PairTerms Terms(std::span<const int> indices) const = 0;

  /// Requires 3D-3D pairs. Pairs i and j are connected where the distances from i to j in both
  /// frames differ by at most sqrt(max_squared) sigmas of that difference.
  virtual BitGraph AgreementGraph(double max_squared) const = 0;

  /// The largest finite r_i^2; 0 where there is none.
  virtual double LargestSquared(const Rigid3d& pose) const = 0;

  /// Sets the weights of graduated non-convexity from the residuals at `pose`; all are 1 at first.
  /// The result has the closed-form fit of the weighted pairs where there is one.
  virtual GncReweighting Reweight(const Rigid3d& pose, const GncWeight& weight_of) = 0;

  /// The weights of the last Reweight, in the order of the pairs. Requires one call of it.
  virtual std::vector<double> Weights() const = 0;

 protected:
  PairScorer(PairKind kind, std::size_t size) : kind_(kind), size_(size) {}

 private:
  PairKind kind_;
  std::size_t size_;
};

/// A ColumnScorer for 3D-3D pairs with isotropic noise, else a TermScorer. Refers to `problem`.
/// Pairs that state no noise have residuals in m or px: see noise_scale.h.
std::unique_ptr<PairScorer> MakePairScorer(const CalibrationProblem& problem, PairKind kind);

/// Whether no pair states a covariance.
bool AreIsotropic(std::span<const Pair3d3d> pairs);

}  // namespace sextant
