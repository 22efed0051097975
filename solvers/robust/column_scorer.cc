// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/column_scorer.h"

#include <cmath>

#include "solvers/kernels/agreement_graph.h"
#include "solvers/robust/pair_statistics.h"

namespace sextant {

// One pass costs less than stopping it early.
double ColumnScorer::CostUpTo(const Rigid3d& pose, double max_squared, double /*give_up*/) const {
  return TruncatedCost(columns_, pose, max_squared);
}

void ColumnScorer::Inliers(const Rigid3d& pose, double max_squared,
                           std::vector<int>& inliers) const {
  InliersOf(columns_, pose, max_squared, inliers);
}

std::optional<Rigid3d> ColumnScorer::FitInliers(const Rigid3d& pose, double max_squared,
                                                const RefineLimits& /*limits*/) {
  const InlierFit fit = sextant::FitInliers(columns_, pose, max_squared);
  if (!fit.fitted) return std::nullopt;
  return fit.cam_from_lidar;
}

void ColumnScorer::SquaredResiduals(const Rigid3d& pose, std::span<double> squared) const {
  SquaredResidualsOf(columns_, pose, squared);
}

double ColumnScorer::RandomAgreementProbability(double max_squared) const {
  Eigen::AlignedBox3d box;
  double sigmas = 0.0;
  for (const Pair3d3d& pair : pairs_) {
    box.extend(pair.point_in_cam);
    sigmas += pair.sigma_m > 0.0 ? pair.sigma_m : 1.0;
  }
  const double radius = std::sqrt(max_squared) * sigmas / static_cast<double>(size());
  return RandomPointProbability(box, radius);
}

int ColumnScorer::CountDistinct(std::span<const int> indices) const {
  return CountDistinctPairs(indices, [this](std::size_t i) {
    const Eigen::Vector3d& c = pairs_[i].point_in_cam;
    const Eigen::Vector3d& l = pairs_[i].point_in_lidar;
    return PairNumbers{c.x(), c.y(), c.z(), l.x(), l.y(), l.z()};
  });
}

PairTerms ColumnScorer::Terms(std::span<const int> indices) const {
  std::vector<Pair3d3d> chosen;
  chosen.reserve(indices.size());
  for (const int i : indices) chosen.push_back(pairs_[static_cast<std::size_t>(i)]);
  PairTerms terms;
  terms.Add(chosen);
  return terms;
}

BitGraph ColumnScorer::AgreementGraph(double max_squared) const {
  return sextant::AgreementGraph(columns_, max_squared);
}

double ColumnScorer::LargestSquared(const Rigid3d& pose) const {
  return LargestSquaredOf(columns_, pose);
}

GncReweighting ColumnScorer::Reweight(const Rigid3d& pose, const GncWeight& weight_of) {
  if (weights_.empty()) weights_.assign(columns_.padded(), 1.0);
  return ReweightColumns(columns_, pose, weight_of, weights_);
}

std::vector<double> ColumnScorer::Weights() const {
  std::vector<double> weights(size());
  for (std::size_t i = 0; i < size(); ++i) weights[i] = weights_[PairColumns::Place(i)];
  return weights;
}

}  // namespace sextant
