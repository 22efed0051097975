// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/robust/pair_scorer.h"

namespace sextant {

/// Pairs of any kind and noise, by their residual terms. A point that does not project has an
/// infinite residual.
class TermScorer final : public PairScorer {
 public:
  explicit TermScorer(PairTerms terms);

  const PairTerms& terms() const { return terms_; }

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
  std::vector<double> Weights() const override { return weights_; }

 private:
  std::optional<Rigid3d> FitIsotropicInliers();

  template <class Visit>
  void ForEach(const Rigid3d& pose, Visit&& visit) const;

  PairTerms terms_;
  std::vector<double> weights_;  // Empty before the first Reweight.
  // Buffers of FitInliers.
  std::vector<int> inliers_;
  PairTerms inlier_terms_;
  std::vector<Eigen::Vector3d> in_cam_;
  std::vector<Eigen::Vector3d> in_lidar_;
  std::vector<double> inverse_variances_;
};

}  // namespace sextant
