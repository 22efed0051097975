// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "geometry/lens_domain.h"
#include "geometry/symmetric.h"
#include "solvers/core/registry.h"
#include "solvers/least_squares/refine_pose.h"
#include "solvers/pnp/explained.h"
#include "solvers/pnp/p3p_solver.h"
#include "solvers/refine/p3p_start.h"
#include "solvers/refine/refine_camera.h"
#include "solvers/refine/refine_ceres.h"
#include "solvers/refine/refine_noise.h"
#include "solvers/refine/refine_options.h"
#include "solvers/robust/noise_scale.h"

namespace sextant {
namespace {

// Fewer pairs than this never determine a pose.
constexpr int kMinPairs = 3;

DataNeeds WithRefined(DataNeeds needs, RefineOn on) {
  if (Uses3d3d(on)) needs.pairs_3d3d = std::max(needs.pairs_3d3d, kMinPairs);
  if (Uses2d3d(on)) needs.pairs_2d3d = std::max(needs.pairs_2d3d, kMinPairs);
  return needs;
}

/// Indices of the pairs of each kind used in the refinement.
struct UsedPairs {
  std::vector<int> points;
  std::vector<int> pixels;
};

std::vector<int> AllOf(std::size_t count) {
  std::vector<int> all(count);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// Indices of `others`, without those whose id occurs among the rejected `pairs` and not among the
// pairs at `kept`.
template <class Pair, class Other>
std::vector<int> NotRejected(const std::vector<Pair>& pairs, const std::vector<int>& kept,
                             const std::vector<Other>& others) {
  using Key = std::tuple<int, int, int>;
  const auto key = [](const PairId& id) { return Key(id.view, id.board, id.corner); };
  std::set<Key> rejected;
  for (const Pair& pair : pairs) rejected.insert(key(pair.id));
  for (const int i : kept) rejected.erase(key(pairs[static_cast<std::size_t>(i)].id));
  std::vector<int> chosen;
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (!rejected.contains(key(others[i].id))) chosen.push_back(static_cast<int>(i));
  }
  return chosen;
}

/// argmin over SE(3) of 1/2 sum rho(|r_i|^2) from the inner solver's pose, r_i whitened by the
/// stated noise of the pairs (full 3x3 covariances included), over the inliers of the inner solver.
/// The inliers of the answer are these, without those to which the loss gives hardly any weight
/// (kMinLossWeight).
///
/// Pairs that state no noise have it estimated: see refine_noise.h.
/// Plain least squares runs in RefinePose, robust losses in Ceres. With on=both, the pairs of the
/// other kind are used too, without the ids that the inner solver rejected. Covariance: inverse of
/// sum rho' J^T J, larger where outliers pull at the pose (see RefinePoseWithCeres); with free
/// intrinsics see refine_camera.h. Termination kConverged: the last step is under step_tolerance.
/// Errors: kNoConvergence, kDegenerate, those of the inner solver.
class RefineSolver final : public Solver {
 public:
  RefineSolver(const SolverArguments& arguments, const RefineOptions& options)
      : Solver({.name = arguments.name,
                .needs = WithRefined(arguments.inner->spec().needs, options.on),
                .estimates_rotation = true,
                .is_global =
                    arguments.inner->spec().is_global && arguments.inner->spec().estimates_rotation,
                .estimates_camera = options.intrinsics != 0U}),
        inner_(arguments.inner),
        options_(options) {}

 private:
  struct QuickAnswer {
    // With a constructor, std::optional builds it in place, by clang 14 too.
    QuickAnswer(Estimate&& answer, bool certain)
        : estimate(std::move(answer)), is_certain(certain) {}

    Estimate estimate;
    bool is_certain;  // The residuals are small; else the start may have been a bad one.
  };

  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    std::optional<QuickAnswer> quick = FromTriples(problem);
    if (quick && quick->is_certain) return std::move(quick->estimate);
    Expected<SolveReport> start = inner_->Solve(problem);
    if (!start && options_.Loss().kind != LossKind::kNone) {
      return FromConsensus(problem, std::move(start.error()));
    }
    if (!start) {
      // Outliers may leave the inner solver a pose that explains nothing, and the refined one much.
      const bool is_refuted = !quick || !CheckExplained(*problem.camera, problem.pairs_2d3d,
                                                        quick->estimate.cam_from_lidar);
      if (is_refuted) return tl::unexpected<Error>(std::move(start.error()));
      return std::move(quick->estimate);
    }
    start->stages.push_back(
        {start->solver, start->cam_from_lidar, start->iterations, start->wall_time_us});
    return RefineFrom(problem, *start);
  }

  std::optional<Estimate> DoSolveFrom(const CalibrationProblem& problem, const Estimate& answer,
                                      const Rigid3d& start) const override {
    Estimate other = answer;
    other.cam_from_lidar = start;
    Expected<Estimate> estimate = RefineFrom(problem, other);
    if (!estimate) return std::nullopt;
    return *std::move(estimate);
  }

  // Outliers may leave the inner solver no pose of all pairs where a loss bears them: then from the
  // pose that more pairs agree on than chance explains.
  Expected<Estimate> FromConsensus(const CalibrationProblem& problem, Error of_inner) const {
    const DataNeeds& needs = inner_->spec().needs;
    const bool of_one_kind = (needs.pairs_3d3d > 0) != (needs.pairs_2d3d > 0);
    if (of_inner.code != ErrorCode::kNoConsensus || !of_one_kind) {
      return tl::unexpected<Error>(std::move(of_inner));
    }
    const PairKind kind = needs.pairs_3d3d > 0 ? PairKind::k3d3d : PairKind::k2d3d;
    const Expected<Rigid3d> pose = FindConsensusPose(problem, kind, *inner_);
    if (!pose) return tl::unexpected<Error>(std::move(of_inner));
    Estimate start;
    start.cam_from_lidar = *pose;
    // Points behind the camera have no residual that a loss could bear.
    const std::size_t count =
        kind == PairKind::k3d3d ? problem.pairs_3d3d.size() : problem.pairs_2d3d.size();
    for (const int i : AllOf(count)) {
      if (kind == PairKind::k3d3d || IsSeen(problem, i, *pose)) start.inliers.push_back(i);
    }
    start.stages.push_back({"consensus", *pose, 0, 0.0});
    return RefineFrom(problem, start);
  }

  static bool IsSeen(const CalibrationProblem& problem, int i, const Rigid3d& pose) {
    const Eigen::Vector3d& point = problem.pairs_2d3d[static_cast<std::size_t>(i)].point_in_lidar;
    return Project(*problem.camera, pose * point).has_value();
  }

  // Least squares from the pose of `start` over its inliers; keeps its alternatives and stages.
  Expected<Estimate> RefineFrom(const CalibrationProblem& problem, const Estimate& start) const {
    const UsedPairs used = Choose(problem, start);
    SEXTANT_RETURN_IF_ERROR(CheckProjects(problem, used, start.cam_from_lidar));
    RefinedPairs pairs(problem, Uses3d3d(options_.on) ? used.points : std::vector<int>(),
                       Uses2d3d(options_.on) ? used.pixels : std::vector<int>());
    SEXTANT_RETURN_IF_ERROR(pairs.EstimateNoise(options_, *inner_, start));
    Expected<Estimate> estimate = options_.intrinsics == 0U
                                      ? PoseOf(pairs.Terms(), pairs.starts())
                                      : PoseAndCameraOf(pairs.Terms(), start.cam_from_lidar);
    if (!estimate) return estimate;
    estimate->noise = pairs.noise();
    estimate->termination = Termination::kConverged;
    estimate->inliers = Inliers(used, pairs.Terms(), *estimate);
    estimate->alternatives = start.alternatives;
    estimate->stages = start.stages;
    return estimate;
  }

  // Plain least squares on pixels from p3p, with the vectorised StartFromTriples in place of p3p
  // itself. None for other settings.
  std::optional<QuickAnswer> FromTriples(const CalibrationProblem& problem) const {
    if (options_.on != RefineOn::k2d3d || options_.Loss().kind != LossKind::kNone ||
        options_.intrinsics != 0U || options_.sigma_px > 0.0 || !IsP3pOfPinhole(*inner_, problem)) {
      return std::nullopt;
    }
    const auto begin = std::chrono::steady_clock::now();
    const PairTerms terms = MakeTerms(problem, PairKind::k2d3d);
    const std::optional<Rigid3d> start = StartFromTriples(terms.pixels.View(), terms.camera);
    const std::chrono::duration<double, std::micro> wall_time =
        std::chrono::steady_clock::now() - begin;
    if (!start) return std::nullopt;
    RefineLimits limits = Limits();
    // At a pose within 1e-6: at the answer itself it would take a fifth of the time for 1000
    // pixels.
    limits.wants_information = false;
    const RefinedPose refined = RefinePose(terms.View(), *start, limits);
    const bool is_certain =
        (!terms.noise_known || IsExplained(refined, terms.size())) &&
        IsSmallAgainstImage(problem.pairs_2d3d, SquaredPixels(problem, refined));
    Expected<Estimate> estimate = EstimateOf(terms, refined);
    if (!estimate) return std::nullopt;
    estimate->termination = Termination::kConverged;
    estimate->inliers = AllOf(terms.size());
    estimate->stages.push_back({inner_->spec().name, *start, 0, wall_time.count()});
    return std::optional<QuickAnswer>(std::in_place, *std::move(estimate), is_certain);
  }

  // Names the first pixel whose point does not project at the start.
  Expected<void> CheckProjects(const CalibrationProblem& problem, const UsedPairs& used,
                               const Rigid3d& start) const {
    if (!Uses2d3d(options_.on)) return {};
    for (const int i : used.pixels) {
      const Eigen::Vector3d in_cam =
          start * problem.pairs_2d3d[static_cast<std::size_t>(i)].point_in_lidar;
      if (Project(*problem.camera, in_cam)) continue;
      return MakeError(
          ErrorCode::kNoConvergence,
          fmt::format("at the answer of '{}' the point of pair {} of {} does not project into the "
                      "image: {}; check this pair, wrap it in ransac or give a better start",
                      inner_->spec().name, i + 1, problem.pairs_2d3d.size(),
                      WhyNotProjected(*problem.camera, in_cam)));
    }
    return {};
  }

  // The sum of squared residuals [px^2], to the accuracy with which the sigmas are alike.
  double SquaredPixels(const CalibrationProblem& problem, const RefinedPose& refined) const {
    const Pair2d3d& first = problem.pairs_2d3d.front();
    const double sigma_px = HasKnownNoise(first) ? first.sigma_px : 1.0;  // Else in pixels.
    return 2.0 * refined.cost * sigma_px * sigma_px;
  }

  // The minimum of the lowest cost that is reached from the starts.
  Expected<Estimate> PoseOf(const PairTerms& terms, std::span<const Rigid3d> starts) const {
    const RobustLoss loss = LossOn(terms);
    std::optional<RefinedPose> best;
    for (const Rigid3d& start : starts) {
      const RefinedPose refined = loss.kind == LossKind::kNone
                                      ? RefinePose(terms.View(), start, Limits())
                                      : RefinePoseWithCeres(terms.View(), start, loss, Limits());
      const bool is_better =
          refined.outcome == RefineOutcome::kConverged &&
          (!best || best->outcome != RefineOutcome::kConverged || refined.cost < best->cost);
      if (!best || is_better) best = refined;
    }
    Expected<Estimate> estimate = EstimateOf(terms, *best);
    if (!estimate || !estimate->covariance) return estimate;
    auto pull = AddOutlierPull(terms.View(), best->cam_from_lidar, loss, *estimate->covariance);
    if (pull) estimate->warnings.push_back(*std::move(pull));
    return estimate;
  }

  // Whether the stated noise explains the residuals of the pixels: their sum of squares is
  // chi-square, and must be at most ten standard deviations above its mean.
  static bool IsExplained(const RefinedPose& refined, std::size_t pixels) {
    const double freedom = std::max(1.0, 2.0 * static_cast<double>(pixels) - 6.0);
    return 2.0 * refined.cost <= freedom + 10.0 * std::sqrt(2.0 * freedom);
  }

  Expected<Estimate> EstimateOf(const PairTerms& terms, const RefinedPose& refined) const {
    SEXTANT_RETURN_IF_ERROR(CheckOutcome(refined));
    std::optional<Matrix6d> inverse = InvertSymmetric(refined.information);
    if (!inverse) {
      return MakeError(ErrorCode::kDegenerate,
                       "the pairs leave a direction of the pose undetermined; use points that span "
                       "a plane");
    }
    Estimate estimate;
    estimate.cam_from_lidar = refined.cam_from_lidar;
    estimate.iterations = refined.iterations;
    estimate.covariance = terms.noise_known
                              ? inverse
                              : LeastSquaresCovariance(terms, refined.information, refined.cost);
    return estimate;
  }

  Expected<Estimate> PoseAndCameraOf(const PairTerms& terms, const Rigid3d& start) const {
    SEXTANT_ASSIGN_OR_RETURN(const std::vector<int> free,
                             FreeIntrinsics(terms.camera, options_.intrinsics));
    return RefinePoseAndCamera(terms, start, free, options_.Loss(), Limits())
        .map([](const RefinedPoseAndCamera& refined) {
          Estimate estimate;
          estimate.cam_from_lidar = refined.cam_from_lidar;
          estimate.iterations = refined.iterations;
          estimate.covariance = refined.covariance;
          estimate.camera = refined.camera;
          estimate.warnings = refined.warnings;
          return estimate;
        });
  }

  // The used pairs of the kind that inliers are of, without those that the loss all but ignores.
  std::vector<int> Inliers(const UsedPairs& used, const PairTerms& terms,
                           const Estimate& estimate) const {
    const bool of_points = spec().needs.pairs_3d3d > 0;
    const std::vector<int>& all = of_points ? used.points : used.pixels;
    const bool are_refined = of_points ? Uses3d3d(options_.on) : Uses2d3d(options_.on);
    const RobustLoss loss = LossOn(terms);
    if (loss.kind == LossKind::kNone || !are_refined) return all;
    TermsView view = terms.View();
    if (estimate.camera) view.camera = &estimate.camera->camera;
    if (of_points) {
      view.pixels = {};
    } else {
      view.points = {};
    }
    std::vector<int> kept;
    for (const int i : WeightedTerms(view, estimate.cam_from_lidar, loss)) {
      kept.push_back(all[static_cast<std::size_t>(i)]);
    }
    return kept.size() < static_cast<std::size_t>(kMinPairs) ? all : kept;
  }

  // None for pairs of unknown noise, which are too few to estimate it (RefinedPairs): a loss has no
  // scale then. In the unit of the residuals it would take three pairs that fit exactly.
  RobustLoss LossOn(const PairTerms& terms) const {
    return terms.noise_known ? options_.Loss() : RobustLoss{};
  }

  RefineLimits Limits() const { return {options_.max_iterations, options_.step_tolerance}; }

  // The inliers of the inner solver's kind of pairs; of the other kind, all without the id of a
  // rejected pair, since an outlier of one kind comes from a sensor that both share.
  UsedPairs Choose(const CalibrationProblem& problem, const Estimate& start) const {
    const DataNeeds& inner = inner_->spec().needs;
    UsedPairs used;
    if (inner.pairs_3d3d > 0) {
      used.points = start.inliers;
      used.pixels = NotRejected(problem.pairs_3d3d, start.inliers, problem.pairs_2d3d);
    } else if (inner.pairs_2d3d > 0) {
      used.pixels = start.inliers;
      used.points = NotRejected(problem.pairs_2d3d, start.inliers, problem.pairs_3d3d);
    } else {
      used.points = AllOf(problem.pairs_3d3d.size());
      used.pixels = AllOf(problem.pairs_2d3d.size());
    }
    return used;
  }

  Expected<void> CheckOutcome(const RefinedPose& refined) const {
    switch (refined.outcome) {
      case RefineOutcome::kConverged:
        break;
      case RefineOutcome::kMaxIterations:
        return MakeError(ErrorCode::kNoConvergence,
                         fmt::format("no convergence within {} iterations from the answer of '{}'; "
                                     "raise max_iterations or give a better start",
                                     options_.max_iterations, inner_->spec().name));
      case RefineOutcome::kStalled:
        return MakeError(ErrorCode::kNoConvergence,
                         fmt::format("no step from the answer of '{}' lowers the cost; are the "
                                     "coordinates in metres and the sigmas right?",
                                     inner_->spec().name));
      case RefineOutcome::kNotProjected:
        return MakeError(ErrorCode::kNoConvergence,
                         fmt::format("at the answer of '{}' a point does not project into the "
                                     "image; wrap it in ransac or give a better start",
                                     inner_->spec().name));
    }
    return {};
  }

  SolverPtr inner_;
  RefineOptions options_;
};

}  // namespace

SolverEntry RefineEntry() {
  return {
      .name = "refine",
      .summary = "least squares over SE(3) from the inner answer, on points, pixels or both",
      .needs = "what the inner solver needs, and 3 pairs of each kind refined on",
      .reference = "Marquardt 1963; losses: Barron 2019",
      .example = "refine(kabsch)",
      .wraps_solver = true,
      .options = RefineOptionSet().Describe(),
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return ParseRefineOptions(arguments).map([&](const RefineOptions& o) -> SolverPtr {
          return std::make_shared<RefineSolver>(arguments, o);
        });
      },
  };
}

}  // namespace sextant
