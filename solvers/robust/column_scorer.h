// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/kernels/pair_columns.h"
#include "solvers/robust/pair_scorer.h"

namespace sextant {

/// 3D-3D pairs with isotropic noise, by the vectorised kernels of pair_columns.h: least squares is
/// closed form. Half the memory of a TermScorer, and no copies of the inliers.
class ColumnScorer final : public PairScorer {
 public:
  /// Refers to `pairs`, none of which may state a covariance.
  explicit ColumnScorer(std::span<const Pair3d3d> pairs)
      : PairScorer(PairKind::k3d3d, pairs.size()), pairs_(pairs), columns_(pairs) {}

  const PairColumns& columns() const { return columns_; }

  double CostUpTo(const Rigid3d& pose, double max_squared, double give_up) const override;
  void Inliers(const Rigid3d& pose, double max_squared, std::vector<int>& inliers) const override;
  std::optional<Rigid3d> FitInliers(const Rigid3d& pose, double max_squared,
                                    const RefineLimits& limits) override;
  void SquaredResiduals(const Rigid3d& pose, std::span<double> squared) const override;
  double RandomAgreementProbability(double max_squared) const override;
  int CountDistinct(std::span<const int> indices) const override;
  PairTerms Terms(std::span<const int> indices) const override;
  BitGraph AgreementGraph(double max_squared) const override;
  double LargestSquared(const Rigid3d& pose) const override;
  GncReweighting Reweight(const Rigid3d& pose, const GncWeight& weight_of) override;
  std::vector<double> Weights() const override;

 private:
  std::span<const Pair3d3d> pairs_;
  PairColumns columns_;
  std::vector<double> weights_;  // In the order of the columns; empty before the first Reweight.
};

}  // namespace sextant
