// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/noise_scale.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "solvers/robust/scale_rating.h"
#include "solvers/robust/triple_source.h"

namespace sextant {
namespace {

constexpr double kLogMaxFalseAlarms = -4.605170185988091;  // log 0.01

/// The search of FindNoiseScale.
class ScaleSearch {
 public:
  ScaleSearch(const CalibrationProblem& problem, PairKind kind, const Solver& inner,
              PairScorer& scorer, std::uint64_t seed)
      : dimension_(ResidualsPerPair(kind)),
        unknowns_(inner.spec().estimates_rotation ? 6.0 : 3.0),
        scorer_(scorer),
        triples_(MakeTripleSource(problem, kind, inner, seed)),
        rating_(scorer, ExtentOf(problem, kind), unknowns_ < 6.0 ? 1 : 3),
        squared_(scorer.size()) {}

  void Run() {
    double wanted = triples_->min_samples();
    while (triples_->samples() < std::min<double>(wanted, triples_->max_samples())) {
      poses_.clear();
      triples_->Next(poses_);
      bool improves = false;
      for (const Rigid3d& pose : poses_) improves = Try(pose) || improves;
      if (improves) wanted = std::max<double>(triples_->min_samples(), Wanted());
    }
    if (best_ && unknowns_ == 6.0) PreferPart();
  }

  bool found() const { return best_.has_value(); }
  bool is_consensus() const { return best_->rating.log_false_alarms < kLogMaxFalseAlarms; }
  const ScaleRating& rating() const { return best_->rating; }

  /// The scale of the best pose, after least squares on the pairs within it.
  NoiseScale Scale() {
    constexpr int kMaxRounds = 10;
    constexpr double kMaxGrowth = 4.0;  // In variance; more are outliers that were let in.
    scorer_.SquaredResiduals(best_->pose, squared_);
    NoiseScale scale{best_->pose, 0.0, best_->rating.inliers};
    double variance = Variance(best_->rating.max_squared);
    const double most = kMaxGrowth * variance;
    for (int round = 0; round < kMaxRounds; ++round) {
      const double within = MaxSquaredOf(dimension_) * variance;
      const int before = std::exchange(scale.inliers, CountWithin(within));
      const auto next = scorer_.FitInliers(scale.cam_from_lidar, within, {});
      if (!next || !next->IsFinite() || (round > 0 && scale.inliers == before)) break;
      scale.cam_from_lidar = *next;
      scorer_.SquaredResiduals(*next, squared_);
      variance = std::min(most, Variance(within));
    }
    scale.sigma = std::sqrt(variance);
    return scale;
  }

 private:
  struct Rated {
    Rigid3d pose;
    ScaleRating rating;
  };

  ScaleRatings Rate(const Rigid3d& pose) {
    scorer_.SquaredResiduals(pose, squared_);
    return rating_.Rate(squared_);
  }

  // Takes the pose if it is the best of all or of a part of the pairs, and in the first case then
  // least squares on its inliers while that is better.
  bool Try(const Rigid3d& pose) {
    if (!pose.IsFinite()) return false;
    const ScaleRatings ratings = Rate(pose);
    for (std::size_t share = 1; share < best_of_.size(); ++share) {
      if (IsBetter(ratings[share], best_of_[share])) best_of_[share] = Rated{pose, ratings[share]};
    }
    if (!IsBetter(ratings[0], best_)) return false;
    best_ = Improved({pose, ratings[0]}, 0);
    return true;
  }

  // After least squares on the inliers of this share, while that is better.
  Rated Improved(Rated best, std::size_t share) {
    constexpr int kMaxRounds = 10;
    for (int round = 0; round < kMaxRounds && unknowns_ == 6.0; ++round) {
      const auto fit = scorer_.FitInliers(best.pose, best.rating.max_squared,
                                          {.max_iterations = 6, .step_tolerance = 1e-8});
      if (!fit || !fit->IsFinite()) break;
      const Rated next{*fit, Rate(*fit)[share]};
      if (!IsBetter(next.rating, best)) break;
      best = next;
    }
    return best;
  }

  static bool IsBetter(const ScaleRating& rating, const std::optional<Rated>& best) {
    return !best || rating.log_false_alarms < best->rating.log_false_alarms;
  }

  // Takes fewer pairs than the best rating where noise alone would not leave these so close to a
  // pose. The rating of a compromise between two groups of pairs may be as good as that of either.
  void PreferPart() {
    const std::optional<Rigid3d> fit =
        scorer_.FitInliers(best_->pose, best_->rating.max_squared, {});
    std::vector<double> of_best(squared_.size());
    scorer_.SquaredResiduals(best_->pose, of_best);
    std::vector<bool> is_in;
    for (const double s : of_best) is_in.push_back(s <= best_->rating.max_squared);
    if (fit && fit->IsFinite()) scorer_.SquaredResiduals(*fit, of_best);
    const Selection all = SelectionOf(of_best, is_in, std::numeric_limits<double>::infinity());
    const double rounding = static_cast<double>(all.count) * rating_.min_squared();
    if (!std::isfinite(all.squares) || !(all.squares > rounding)) return;
    double least = kLogMaxFalseAlarms;
    for (std::size_t share = 1; share < best_of_.size(); ++share) {
      if (!best_of_[share]) continue;
      const Rated part = Improved(*best_of_[share], share);
      if (!(part.rating.log_false_alarms < kLogMaxFalseAlarms)) continue;
      scorer_.SquaredResiduals(part.pose, squared_);
      const Selection of_part = SelectionOf(squared_, is_in, part.rating.max_squared);
      const double chance =
          LogChanceOfSelection(dimension_, all.count, of_part.count, of_part.squares, all.squares);
      if (!(chance < least)) continue;
      least = chance;
      best_ = part;
    }
  }

  struct Selection {
    std::size_t count = 0;
    double squares = 0.0;
  };

  // The pairs that are in and within max_squared.
  static Selection SelectionOf(const std::vector<double>& squared, const std::vector<bool>& is_in,
                               double max_squared) {
    Selection selection;
    for (std::size_t i = 0; i < squared.size(); ++i) {
      if (!is_in[i] || !(squared[i] <= max_squared)) continue;
      ++selection.count;
      selection.squares += squared[i];
    }
    return selection;
  }

  double Wanted() const {
    constexpr double kConfidence = 0.9999;
    return WantedSamples(scorer_.size(), static_cast<std::size_t>(best_->rating.inliers), 3,
                         kConfidence);
  }

  int CountWithin(double max_squared) const {
    return static_cast<int>(std::count_if(squared_.begin(), squared_.end(),
                                          [&](double s) { return s <= max_squared; }));
  }

  double Variance(double max_squared) const {
    return std::max(rating_.min_squared(),
                    VarianceWithin(squared_, dimension_, unknowns_, max_squared));
  }

  static double MaxSquaredOf(int dimension) {
    return InlierOptions{}.MaxSquared(dimension == 3 ? PairKind::k3d3d : PairKind::k2d3d);
  }

  int dimension_;
  double unknowns_;
  PairScorer& scorer_;
  std::unique_ptr<TripleSource> triples_;
  ScaleRater rating_;
  std::vector<double> squared_;
  std::vector<Rigid3d> poses_;
  std::optional<Rated> best_;
  std::array<std::optional<Rated>, kRatedShares.size()> best_of_;  // But of all pairs: best_.
};

bool StatesNoise(const CalibrationProblem& problem, PairKind kind) {
  return kind == PairKind::k3d3d ? HasKnownNoise(problem.pairs_3d3d.front())
                                 : HasKnownNoise(problem.pairs_2d3d.front());
}

// The sigma of the inliers of an answer that was chosen with `sigma`.
double SigmaOfInliers(const CalibrationProblem& problem, PairKind kind, const Solver& inner,
                      double max_squared, const Estimate& estimate) {
  const std::unique_ptr<PairScorer> scorer = MakePairScorer(problem, kind);
  std::vector<double> all(scorer->size());
  scorer->SquaredResiduals(estimate.cam_from_lidar, all);
  std::vector<double> squared;
  for (const int i : estimate.inliers) squared.push_back(all[static_cast<std::size_t>(i)]);
  const double unknowns = inner.spec().estimates_rotation ? 6.0 : 3.0;
  const double largest = *std::max_element(squared.begin(), squared.end());
  return std::sqrt(
      VarianceWithin(squared, ResidualsPerPair(kind), unknowns, std::max(largest, max_squared)));
}

void SetNoise(PairKind kind, double sigma, bool is_given, Estimate& estimate) {
  estimate.noise.emplace();
  estimate.noise->is_given = is_given;
  (kind == PairKind::k3d3d ? estimate.noise->sigma_m : estimate.noise->sigma_px) = sigma;
}

}  // namespace

Expected<NoiseScale> FindNoiseScale(const CalibrationProblem& problem, PairKind kind,
                                    const Solver& inner, std::uint64_t seed) {
  const std::unique_ptr<PairScorer> scorer = MakePairScorer(problem, kind);
  if (!(ExtentOf(problem, kind) < 1e150)) {
    return MakeError(ErrorCode::kNoConsensus, "the coordinates are too large; are they in metres?");
  }
  ScaleSearch search(problem, kind, inner, *scorer, seed);
  search.Run();
  if (!search.found()) {
    return MakeError(
        ErrorCode::kDegenerate,
        "no sample of pairs determines a pose; the points coincide or lie on one line");
  }
  if (!search.is_consensus()) {
    return MakeError(
        ErrorCode::kNoConsensus,
        fmt::format("no pose gathers more pairs than chance explains: at best {} of {} are within "
                    "{:.3g} {} of one; check the pairing, or state their noise",
                    search.rating().inliers, scorer->size(), std::sqrt(search.rating().max_squared),
                    kind == PairKind::k3d3d ? "m" : "px"));
  }
  return search.Scale();
}

Expected<Rigid3d> FindConsensusPose(const CalibrationProblem& problem, PairKind kind,
                                    const Solver& inner) {
  CalibrationProblem unstated = WithSigma(problem, kind, 0.0);
  for (Pair3d3d& pair : unstated.pairs_3d3d) pair.covariance_in_cam.reset();
  return FindNoiseScale(unstated, kind, inner, kScaleSeed).map([](const NoiseScale& scale) {
    return scale.cam_from_lidar;
  });
}

CalibrationProblem WithSigma(const CalibrationProblem& problem, PairKind kind, double sigma) {
  CalibrationProblem stated;
  stated.camera = problem.camera;
  stated.boards = problem.boards;
  stated.initial_cam_from_lidar = problem.initial_cam_from_lidar;
  if (kind == PairKind::k3d3d) {
    stated.pairs_3d3d = problem.pairs_3d3d;
    for (Pair3d3d& pair : stated.pairs_3d3d) pair.sigma_m = sigma;
  } else {
    stated.pairs_2d3d = problem.pairs_2d3d;
    for (Pair2d3d& pair : stated.pairs_2d3d) pair.sigma_px = sigma;
  }
  return stated;
}

Expected<Estimate> SolveWithNoise(const CalibrationProblem& problem, PairKind kind,
                                  const InlierOptions& options, const Solver& inner,
                                  std::uint64_t seed, const MethodForKnownNoise& solve) {
  if (StatesNoise(problem, kind)) return solve(problem);
  const double given = options.Sigma(kind);
  if (given > 0.0) {
    Expected<Estimate> estimate = solve(WithSigma(problem, kind, given));
    if (estimate) SetNoise(kind, given, true, *estimate);
    return estimate;
  }
  constexpr int kMaxSolves = 3;
  constexpr double kSimilar = 1.2;
  SEXTANT_ASSIGN_OR_RETURN(const NoiseScale scale, FindNoiseScale(problem, kind, inner, seed));
  double sigma = scale.sigma;
  for (int solves = 1;; ++solves) {
    Expected<Estimate> estimate = solve(WithSigma(problem, kind, sigma));
    if (!estimate) return estimate;
    const double found =
        SigmaOfInliers(problem, kind, inner, options.MaxSquared(kind) * sigma * sigma, *estimate);
    const bool settled = found < kSimilar * sigma && sigma < kSimilar * found;
    if (settled || solves == kMaxSolves || found < scale.sigma / kSimilar) {
      if (estimate->covariance) *estimate->covariance *= found * found / (sigma * sigma);
      SetNoise(kind, found, false, *estimate);
      return estimate;
    }
    sigma = found;
  }
}

}  // namespace sextant
