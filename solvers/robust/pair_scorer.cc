// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/pair_scorer.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "geometry/pair_noise.h"
#include "solvers/kernels/agreement_graph.h"
#include "solvers/robust/column_consensus.h"

namespace sextant {
namespace {

// Of least squares on the inliers; far fewer are needed.
constexpr int kMaxRounds = 20;

/// Of pairs with any noise.
class TermsScorer final : public PairScorer {
 public:
  TermsScorer(const Solver& inner, const CalibrationProblem& problem, const InlierOptions& options)
      : inner_(inner),
        problem_(problem),
        options_(options),
        terms_(MakeTerms(problem, PairKind::k3d3d, options.Assumed())),
        lengths_(terms_, options.MaxSquared(PairKind::k3d3d)),
        poses_(terms_, options.FinalMaxSquared(
                           terms_.size(), RandomAgreementProbability(terms_, kChiSquare3At9999))) {}

  BitGraph Graph() const override {
    const std::vector<Pair3d3d>& pairs = problem_.pairs_3d3d;
    std::vector<Eigen::Matrix3d> noise;
    noise.reserve(pairs.size());
    for (const Pair3d3d& pair : pairs) {
      noise.push_back(HasKnownNoise(pair) ? StatedCovariance(pair)
                                          : Eigen::Matrix3d(Eigen::Matrix3d::Identity() *
                                                            options_.sigma_m * options_.sigma_m));
    }
    BitGraph graph(static_cast<int>(pairs.size()));
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const Eigen::Vector3d in_cam = pairs[i].point_in_cam - pairs[j].point_in_cam;
        const double lidar_length = (pairs[i].point_in_lidar - pairs[j].point_in_lidar).norm();
        const double cam_squared = in_cam.squaredNorm();
        const double excess = std::sqrt(cam_squared) - lidar_length;
        // excess^2 <= max_squared u^T S u, without the division by |c|^2.
        const double spread = in_cam.dot((noise[i] + noise[j]) * in_cam);
        if (excess * excess * cam_squared <= lengths_.max_squared() * spread) {
          graph.Connect(static_cast<int>(i), static_cast<int>(j));
        }
      }
    }
    return graph;
  }

  double Cost(const Rigid3d& pose) const override { return poses_.Cost(pose); }

  Rigid3d Optimise(const Rigid3d& pose) const override {
    InlierWorkspace workspace;
    return OptimiseOnInliers(terms_, poses_, pose, kMaxRounds, {}, workspace);
  }

  Expected<void> Check(std::span<const int> inliers, int least) const override {
    return CheckConsensus(terms_, lengths_, inliers, least);
  }

  Expected<Estimate> Answer(const Rigid3d& pose) const override {
    return BetterOnInliers(inner_, problem_, terms_, poses_, pose);
  }

 private:
  const Solver& inner_;
  const CalibrationProblem& problem_;
  const InlierOptions& options_;
  PairTerms terms_;
  PoseScorer lengths_;
  PoseScorer poses_;
};

/// Of isotropic pairs.
class ColumnsScorer final : public PairScorer {
 public:
  ColumnsScorer(const Solver& inner, const CalibrationProblem& problem,
                const InlierOptions& options)
      : inner_(inner),
        problem_(problem),
        options_(options),
        pairs_(problem.pairs_3d3d, options.Assumed()),
        max_squared_(options.FinalMaxSquared(
            pairs_.size(), RandomAgreementProbability(pairs_, kChiSquare3At9999))) {}

  BitGraph Graph() const override {
    return AgreementGraph(pairs_, options_.MaxSquared(PairKind::k3d3d));
  }

  double Cost(const Rigid3d& pose) const override {
    return TruncatedCost(pairs_, pose, max_squared_);
  }

  Rigid3d Optimise(const Rigid3d& pose) const override {
    return OptimiseOnInliers(pairs_, pose, max_squared_);
  }

  Expected<void> Check(std::span<const int> inliers, int least) const override {
    return CheckConsensus(pairs_, options_.MaxSquared(PairKind::k3d3d), inliers, least);
  }

  Expected<Estimate> Answer(const Rigid3d& pose) const override {
    std::optional<Estimate> refit = RefitIfNoWorse(inner_, problem_, pairs_, pose, max_squared_);
    if (refit) return std::move(*refit);
    return TermsScorer(inner_, problem_, options_).Answer(pose);
  }

 private:
  const Solver& inner_;
  const CalibrationProblem& problem_;
  const InlierOptions& options_;
  PairColumns pairs_;
  double max_squared_;
};

}  // namespace

bool AreIsotropic(std::span<const Pair3d3d> pairs) {
  return std::none_of(pairs.begin(), pairs.end(),
                      [](const Pair3d3d& pair) { return pair.covariance_in_cam.has_value(); });
}

Expected<void> CheckConsensus(const PairColumns& pairs, double max_squared,
                              std::span<const int> inliers, int least) {
  return CheckConsensus(PairKind::k3d3d, CountDistinctAtLeast(pairs, inliers),
                        static_cast<int>(pairs.size()),
                        RandomAgreementProbability(pairs, max_squared), least);
}

std::unique_ptr<PairScorer> MakePairScorer(const Solver& inner, const CalibrationProblem& problem,
                                           const InlierOptions& options) {
  if (AreIsotropic(problem.pairs_3d3d)) {
    return std::make_unique<ColumnsScorer>(inner, problem, options);
  }
  return std::make_unique<TermsScorer>(inner, problem, options);
}

Expected<Estimate> RefitOnInliers(const Solver& inner, const CalibrationProblem& problem,
                                  const PairColumns& pairs, const Rigid3d& pose,
                                  double max_squared) {
  const auto by_columns = [&](const Rigid3d& at, std::vector<int>& inliers) {
    inliers = InliersOf(pairs, at, max_squared);
  };
  return RefitOnInliers(inner, problem, by_columns, pose);
}

std::optional<Estimate> RefitIfNoWorse(const Solver& inner, const CalibrationProblem& problem,
                                       const PairColumns& pairs, const Rigid3d& pose,
                                       double max_squared) {
  constexpr double kRounding = 1e-9;
  Expected<Estimate> refit = RefitOnInliers(inner, problem, pairs, pose, max_squared);
  if (!refit) return std::nullopt;
  const bool is_worse = TruncatedCost(pairs, refit->cam_from_lidar, max_squared) >
                        (1.0 + kRounding) * TruncatedCost(pairs, pose, max_squared);
  if (inner.spec().estimates_rotation && is_worse) return std::nullopt;
  return std::move(*refit);
}

}  // namespace sextant
