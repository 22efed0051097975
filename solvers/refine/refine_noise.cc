// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine/refine_noise.h"

#include <algorithm>
#include <cmath>

#include "geometry/symmetric.h"
#include "solvers/least_squares/refine_pose.h"
#include "solvers/robust/noise_scale.h"

namespace sextant {
namespace {

template <class Pair>
std::vector<Pair> PairsAt(const std::vector<Pair>& pairs, std::span<const int> indices) {
  std::vector<Pair> selected;
  selected.reserve(indices.size());
  for (const int i : indices) selected.push_back(pairs[static_cast<std::size_t>(i)]);
  return selected;
}

std::optional<double>& SigmaOf(PairKind kind, NoiseEstimate& noise) {
  return kind == PairKind::k3d3d ? noise.sigma_m : noise.sigma_px;
}

// The cost and the information of terms at a pose: with one iteration, no step is taken.
RefinedPose At(const TermsView& terms, const Rigid3d& pose) {
  return RefinePose(terms, pose, {.max_iterations = 1});
}

}  // namespace

RefinedPairs::RefinedPairs(const CalibrationProblem& problem, std::span<const int> points,
                           std::span<const int> pixels) {
  problem_.camera = problem.camera;
  problem_.initial_cam_from_lidar = problem.initial_cam_from_lidar;
  problem_.pairs_3d3d = PairsAt(problem.pairs_3d3d, points);
  problem_.pairs_2d3d = PairsAt(problem.pairs_2d3d, pixels);
}

bool RefinedPairs::IsUnstated(PairKind kind) const {
  return kind == PairKind::k3d3d
             ? !problem_.pairs_3d3d.empty() && !HasKnownNoise(problem_.pairs_3d3d.front())
             : !problem_.pairs_2d3d.empty() && !HasKnownNoise(problem_.pairs_2d3d.front());
}

void RefinedPairs::SetSigma(PairKind kind, double sigma) {
  if (!noise_) noise_.emplace();
  SigmaOf(kind, *noise_) = sigma;
  if (kind == PairKind::k3d3d) {
    for (Pair3d3d& pair : problem_.pairs_3d3d) pair.sigma_m = sigma;
  } else {
    for (Pair2d3d& pair : problem_.pairs_2d3d) pair.sigma_px = sigma;
  }
}

Expected<void> RefinedPairs::EstimateNoise(const RefineOptions& options, const Solver& inner,
                                           const Estimate& start) {
  constexpr PairKind kKinds[] = {PairKind::k3d3d, PairKind::k2d3d};
  starts_ = {start.cam_from_lidar};
  bool is_unknown = false;
  for (const PairKind kind : kKinds) {
    if (!IsUnstated(kind)) continue;
    const double given = kind == PairKind::k3d3d ? options.sigma_m : options.sigma_px;
    if (given > 0.0) {
      SetSigma(kind, given);
      noise_->is_given = true;
    } else if (options.loss != LossKind::kNone) {
      SEXTANT_RETURN_IF_ERROR(FindScale(kind, inner));
    } else {
      is_unknown = true;
    }
  }
  const bool both = !problem_.pairs_3d3d.empty() && !problem_.pairs_2d3d.empty();
  if (is_unknown && both) BalanceKinds(start.cam_from_lidar);
  return {};
}

Expected<void> RefinedPairs::FindScale(PairKind kind, const Solver& inner) {
  // A loss has no effect on so few pairs, which fit nearly exactly.
  constexpr std::size_t kMaxWithoutChoice = 4;
  const std::size_t count =
      kind == PairKind::k3d3d ? problem_.pairs_3d3d.size() : problem_.pairs_2d3d.size();
  if (count <= kMaxWithoutChoice) return {};
  SEXTANT_ASSIGN_OR_RETURN(const NoiseScale scale,
                           FindNoiseScale(problem_, kind, inner, kScaleSeed));
  SetSigma(kind, scale.sigma);
  starts_.push_back(scale.cam_from_lidar);
  return {};
}

void RefinedPairs::BalanceKinds(const Rigid3d& start) {
  constexpr int kMaxRounds = 50;
  constexpr double kSettled = 1e-4;
  const bool unstated[] = {IsUnstated(PairKind::k3d3d), IsUnstated(PairKind::k2d3d)};
  Rigid3d pose = start;
  for (int round = 0; round < kMaxRounds; ++round) {
    const PairTerms terms = Terms();
    const TermsView all = terms.View();
    const TermsView parts[] = {{all.points, {}, all.camera}, {{}, all.pixels, all.camera}};
    if (round > 0) pose = RefinePose(all, pose, {}).cam_from_lidar;
    const auto covariance = InvertSymmetric(At(all, pose).information);
    if (!covariance) return;
    double change = 0.0;
    for (const PairKind kind : {PairKind::k3d3d, PairKind::k2d3d}) {
      const auto k = static_cast<std::size_t>(kind == PairKind::k2d3d);
      if (!unstated[k]) continue;
      const RefinedPose part = At(parts[k], pose);
      const double residuals = ResidualsPerPair(kind) *
                               static_cast<double>(parts[k].points.size() + parts[k].pixels.size());
      // At the start nothing was fitted with these weights yet.
      const double fitted = round == 0 ? 0.0 : (*covariance * part.information).trace();
      const double factor = std::sqrt(2.0 * part.cost / std::max(1.0, residuals - fitted));
      const double before = noise_ && SigmaOf(kind, *noise_) ? *SigmaOf(kind, *noise_) : 1.0;
      constexpr double kExact = 1e-12;
      SetSigma(kind, std::max(kExact, before * factor));
      change = std::max(change, std::abs(factor - 1.0));
    }
    if (change < kSettled) return;
  }
}

PairTerms RefinedPairs::Terms() const {
  PairTerms terms;
  if (!problem_.pairs_3d3d.empty()) terms.Add(problem_.pairs_3d3d);
  if (!problem_.pairs_2d3d.empty()) terms.Add(problem_.pairs_2d3d, *problem_.camera);
  return terms;
}

}  // namespace sextant
