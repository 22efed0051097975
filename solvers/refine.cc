// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <tuple>

#include "solvers/consensus.h"
#include "solvers/refine_ceres.h"
#include "solvers/refine_pose.h"
#include "solvers/registry.h"

namespace sextant {
namespace {

enum class RefineOn { kAuto, k3d3d, k2d3d, kBoth };

struct RefineOptions {
  RefineOn on = RefineOn::kAuto;
  LossKind loss = LossKind::kNone;
  double loss_scale = 0.0;
  double loss_shape = RobustLoss{}.shape;
  int max_iterations = RefineLimits{}.max_iterations;
  double step_tolerance = RefineLimits{}.step_tolerance;
  double sigma_m = AssumedNoise{}.sigma_m;
  double sigma_px = AssumedNoise{}.sigma_px;

  RobustLoss Loss() const {
    // Beyond most residuals of clean pairs, whose root mean square is sqrt(3) or sqrt(2).
    constexpr double kScales[] = {2.0, 2.0, 3.0, 6.0, 3.0};
    const double scale = loss_scale > 0.0 ? loss_scale : kScales[static_cast<std::size_t>(loss)];
    return {loss, scale, loss_shape};
  }
};

// Fewer pairs than this leave a direction undetermined whatever their places.
constexpr int kLeastPairs = 3;

bool Uses3d3d(RefineOn on) { return on == RefineOn::k3d3d || on == RefineOn::kBoth; }
bool Uses2d3d(RefineOn on) { return on == RefineOn::k2d3d || on == RefineOn::kBoth; }

DataNeeds WithRefined(DataNeeds needs, RefineOn on) {
  if (Uses3d3d(on)) needs.pairs_3d3d = std::max(needs.pairs_3d3d, kLeastPairs);
  if (Uses2d3d(on)) needs.pairs_2d3d = std::max(needs.pairs_2d3d, kLeastPairs);
  return needs;
}

template <class Pair>
std::vector<Pair> PairsAt(const std::vector<Pair>& pairs, const std::vector<int>& indices) {
  std::vector<Pair> selected;
  selected.reserve(indices.size());
  for (const int i : indices) selected.push_back(pairs[static_cast<std::size_t>(i)]);
  return selected;
}

/// Indices of the pairs of each kind that are refined on.
struct UsedPairs {
  std::vector<int> points;
  std::vector<int> pixels;
};

std::vector<int> AllOf(std::size_t count) {
  std::vector<int> all(count);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

// Indices of `others` but those whose id is that of a pair at none of `kept`, and of none that is.
template <class Pair, class Other>
std::vector<int> NotLeftOut(const std::vector<Pair>& pairs, const std::vector<int>& kept,
                            const std::vector<Other>& others) {
  using Key = std::tuple<int, int, int>;
  const auto key = [](const PairId& id) { return Key(id.view, id.board, id.corner); };
  std::set<Key> left_out;
  for (const Pair& pair : pairs) left_out.insert(key(pair.id));
  for (const int i : kept) left_out.erase(key(pairs[static_cast<std::size_t>(i)].id));
  std::vector<int> chosen;
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (!left_out.contains(key(others[i].id))) chosen.push_back(static_cast<int>(i));
  }
  return chosen;
}

/// argmin over SE(3) of 1/2 sum rho(|r_i|^2) from the inner solver's answer, r_i whitened by what
/// the pairs state (full 3x3 covariances included), on the pairs that this answer rests on.
///
/// Plain least squares runs in RefinePose, robust losses in Ceres. With on=both, so are the
/// other kind's pairs but for the ids that this answer left out. Covariance: inverse of sum rho'
/// J^T J. Termination kConverged: the last step is under step_tolerance. Errors: kNoConvergence,
/// kDegenerate, those of the inner solver.
class RefineSolver final : public Solver {
 public:
  RefineSolver(const SolverArguments& arguments, RefineOn on, const RefineOptions& options)
      : Solver({.name = arguments.name,
                .needs = WithRefined(arguments.inner->spec().needs, on),
                .estimates_rotation = true,
                .is_global = arguments.inner->spec().is_global &&
                             arguments.inner->spec().estimates_rotation}),
        inner_(arguments.inner),
        on_(on),
        options_(options) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    Expected<SolveReport> start = inner_->Solve(problem);
    if (!start) return tl::unexpected<Error>(std::move(start.error()));
    const UsedPairs used = Choose(problem, *start);
    const PairTerms terms = TermsOf(problem, used);
    const RefineLimits limits{options_.max_iterations, options_.step_tolerance};
    const RobustLoss loss = options_.Loss();
    const RefinedPose refined =
        loss.kind == LossKind::kNone
            ? RefinePose(terms.View(), start->cam_from_lidar, limits)
            : RefinePoseWithCeres(terms.View(), start->cam_from_lidar, loss, limits);
    if (Expected<void> ok = CheckOutcome(refined); !ok) {
      return tl::unexpected<Error>(std::move(ok.error()));
    }
    Estimate estimate;
    estimate.cam_from_lidar = refined.cam_from_lidar;
    estimate.termination = Termination::kConverged;
    estimate.iterations = refined.iterations;
    estimate.covariance = LeastSquaresCovariance(terms, refined.information, refined.cost);
    estimate.inliers = spec().needs.pairs_3d3d > 0 ? used.points : used.pixels;
    estimate.stages = std::move(start->stages);
    estimate.stages.push_back(
        {start->solver, start->cam_from_lidar, start->iterations, start->wall_time_us});
    return estimate;
  }

  // Of the inner solver's kind, the inliers; of the other, all but those that carry the id of a
  // pair left out, since an outlier of one kind comes from a sensor that both share.
  UsedPairs Choose(const CalibrationProblem& problem, const Estimate& start) const {
    const DataNeeds& inner = inner_->spec().needs;
    UsedPairs used;
    if (inner.pairs_3d3d > 0) {
      used.points = start.inliers;
      used.pixels = NotLeftOut(problem.pairs_3d3d, start.inliers, problem.pairs_2d3d);
    } else if (inner.pairs_2d3d > 0) {
      used.pixels = start.inliers;
      used.points = NotLeftOut(problem.pairs_2d3d, start.inliers, problem.pairs_3d3d);
    } else {
      used.points = AllOf(problem.pairs_3d3d.size());
      used.pixels = AllOf(problem.pairs_2d3d.size());
    }
    return used;
  }

  PairTerms TermsOf(const CalibrationProblem& problem, const UsedPairs& used) const {
    const AssumedNoise assumed{options_.sigma_m, options_.sigma_px};
    PairTerms terms;
    if (Uses3d3d(on_)) terms.Add(PairsAt(problem.pairs_3d3d, used.points), assumed);
    if (Uses2d3d(on_)) {
      terms.Add(PairsAt(problem.pairs_2d3d, used.pixels), *problem.camera, assumed);
    }
    return terms;
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
    if (!InvertInformation(refined.information)) {
      return MakeError(ErrorCode::kDegenerate,
                       "the pairs leave a direction of the pose undetermined; use points that span "
                       "a plane");
    }
    return {};
  }

  SolverPtr inner_;
  RefineOn on_;
  RefineOptions options_;
};

OptionSet<RefineOptions> RefineOptionSet() {
  OptionSet<RefineOptions> options;
  options
      .Choice("on", &RefineOptions::on, {"auto", "3d3d", "2d3d", "both"},
              "the residuals; auto: those of the inner solver")
      .Choice("loss", &RefineOptions::loss, {"none", "huber", "cauchy", "tukey", "barron"},
              "robust loss on each pair")
      .Real("loss_scale", &RefineOptions::loss_scale, "sigma", 0.0, 1e6,
            "where the loss bends; 0: huber 2, cauchy 3, tukey 6, barron 3")
      .Real("loss_shape", &RefineOptions::loss_shape, "1", -100.0, 2.0,
            "of barron: 2 squares, 1 Charbonnier, 0 Cauchy, -2 Geman-McClure")
      .Count("max_iterations", &RefineOptions::max_iterations, 1, 1'000'000,
             "more are kNoConvergence")
      .Real("step_tolerance", &RefineOptions::step_tolerance, "rad and m", 1e-15, 1.0,
            "the iteration ends with a step smaller than this")
      .Real("sigma_m", &RefineOptions::sigma_m, "m", 1e-9, 1e6,
            "assumed of pairs that state no sigma")
      .Real("sigma_px", &RefineOptions::sigma_px, "px", 1e-6, 1e6,
            "assumed of pairs that state no sigma");
  return options;
}

Expected<RefineOn> ResolveOn(const SolverArguments& arguments, RefineOn on) {
  if (on != RefineOn::kAuto) return on;
  const DataNeeds& needs = arguments.inner->spec().needs;
  if (needs.pairs_3d3d > 0 && needs.pairs_2d3d > 0) return RefineOn::kBoth;
  if (needs.pairs_3d3d > 0) return RefineOn::k3d3d;
  if (needs.pairs_2d3d > 0) return RefineOn::k2d3d;
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("refine: '{}' works on point sets; say on which pairs to refine: "
                               "on=3d3d, on=2d3d or on=both",
                               arguments.inner->spec().name));
}

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
        const Expected<RefineOptions> options = RefineOptionSet().Parse(arguments.options);
        if (!options) return tl::unexpected<Error>(options.error());
        const Expected<RefineOn> on = ResolveOn(arguments, options->on);
        if (!on) return tl::unexpected<Error>(on.error());
        return std::make_shared<RefineSolver>(arguments, *on, *options);
      },
  };
}

}  // namespace sextant
