// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_search.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/median.h"
#include "solvers/joint/joint_contradiction.h"

namespace sextant {
namespace {

constexpr int kMaxRounds = 20;
// Tolerance [rad, m] of a minimum that is only the start of the next round.
constexpr double kNearEnough = 1e-4;
constexpr double kRoundTolerance = 1e-6;
// Least shift of the views while outliers among them are unknown.
constexpr double kLooseShift_m = 0.005;
// Less shift makes no difference to which view contradicts the others.
constexpr double kDecisionShift_m = 1e-4;

RobustLoss LossOf(JointLoss kind, double scale) {
  constexpr LossKind kKinds[] = {LossKind::kNone, LossKind::kHuber, LossKind::kCauchy};
  return {.kind = kKinds[static_cast<std::size_t>(kind)], .scale = scale};
}

class JointSearch {
 public:
  JointSearch(const JointModel& model, const JointState& start, double shift_m,
              const JointOptions& options)
      : model_(model),
        options_(options),
        shift_m_(std::max(shift_m, kNoShift_m)),
        problem_(model, start) {
    noise_.out_of_plane_m = noise_.in_plane_m = std::max(shift_m_, kLooseShift_m);
    left_out_.assign(model.views.size(), false);
  }

  Expected<JointAnswer> Run() {
    const bool cuts = options_.cut > 0.0;
    if (IsRobust() || IsEstimated() || cuts) SEXTANT_RETURN_IF_ERROR(FollowLosses(kNearEnough));
    if (cuts) {
      SEXTANT_RETURN_IF_ERROR(Cut());
    } else {
      noise_ = {.out_of_plane_m = shift_m_, .in_plane_m = shift_m_};
      if (IsEstimated()) noise_ = MedianNoise(Residuals(), noise_);
      SEXTANT_RETURN_IF_ERROR(FollowLosses(options_.step_tolerance));
    }
    SEXTANT_RETURN_IF_ERROR(AddUncertainty());
    answer_.state = problem_.state();
    answer_.noise = noise_;
    return std::move(answer_);
  }

 private:
  bool IsRobust() const {
    return options_.pixel_loss != JointLoss::kNone || options_.face_loss != JointLoss::kNone ||
           options_.edge_loss != JointLoss::kNone;
  }
  bool IsEstimated() const { return options_.noise == JointNoiseLevel::kEstimated; }
  bool HasShift() const { return shift_m_ > kNoShift_m; }

  std::vector<BoardViewResiduals> Residuals() const {
    std::vector<BoardViewResiduals> residuals;
    for (std::size_t i = 0; i < model_.views.size(); ++i) {
      residuals.push_back(ResidualsAt(model_, problem_.state(), i));
    }
    return residuals;
  }

  JointLosses Losses() const {
    const double scale = options_.loss_scale;
    return {LossOf(options_.pixel_loss, scale), LossOf(options_.face_loss, scale),
            LossOf(options_.edge_loss, scale),
            LossOf(IsRobust() ? JointLoss::kCauchy : JointLoss::kNone, scale)};
  }

  static tl::unexpected<Error> Undetermined() {
    return MakeError(ErrorCode::kDegenerate,
                     "the views leave a direction of the pose undetermined; hold the board at "
                     "more positions and tilts");
  }

  // Iteratively reweighted least squares.
  Expected<void> FollowLosses(double tolerance) {
    const bool is_last = tolerance < kNearEnough;
    for (int round = 0; round < kMaxRounds; ++round) {
      const std::vector<BoardViewResiduals> residuals = Residuals();
      if (!is_last) LoosenNoise(residuals);
      constexpr double kAll = std::numeric_limits<double>::infinity();
      answer_.selection = SelectWithin(residuals, noise_, kAll);
      const Rigid3d before = problem_.state().cam_from_lidar;
      const Expected<void> ok = Minimise(residuals, Losses(), tolerance);
      if (!ok && (is_last || ok.error().code != ErrorCode::kNoConvergence)) return ok;
      const Vector6d step = PoseDifference(problem_.state().cam_from_lidar, before);
      if (step.norm() < std::max(10.0 * tolerance, 1e-9) || (is_last && !IsRobust())) break;
    }
    return {};
  }

  // While the pose is inaccurate, the sensors disagree about every view.
  void LoosenNoise(const std::vector<BoardViewResiduals>& residuals) {
    if (IsEstimated()) noise_ = MedianNoise(residuals, noise_);
    std::vector<double> shifts;
    for (std::size_t i = 0; i < model_.views.size(); ++i) {
      shifts.push_back(LinkError(problem_.state(), i, model_.views[i].lever_m).norm());
    }
    noise_.out_of_plane_m = noise_.in_plane_m =
        std::max({shift_m_, kLooseShift_m, Median(shifts) / std::sqrt(6.0)});
  }

  // Alternates least squares, noise and selection until all stay the same, while views that are
  // left out are still compared; then the minimum over what is selected.
  Expected<void> Cut() {
    SEXTANT_RETURN_IF_ERROR(JudgeLosses());
    for (int round = 0; round < kMaxRounds; ++round) {
      const JointSelection before = answer_.selection;
      answer_.selection = SelectWithin(Residuals(), noise_, options_.cut);
      SEXTANT_RETURN_IF_ERROR(Minimise(Residuals(), {}, RoundTolerance()));
      SEXTANT_ASSIGN_OR_RETURN(const Sums sums, SumsNow());
      const std::vector<bool> left_out = LeftOutBy(sums.views);
      const JointNoise noise = IsEstimated() ? NoiseOf(sums) : noise_;
      const bool settled =
          before == answer_.selection && left_out == left_out_ && IsSameNoise(noise, noise_);
      left_out_ = left_out;
      noise_ = noise;
      if (settled) break;
    }
    return Finish();
  }

  double RoundTolerance() const { return std::max(kRoundTolerance, options_.step_tolerance); }

  // The level of the links by their median, and the first views to leave out.
  Expected<void> JudgeLosses() {
    SEXTANT_ASSIGN_OR_RETURN(const Sums sums, SumsNow());
    left_out_ = LeftOutBy(sums.views);
    if (IsEstimated() && HasShift()) {
      noise_ = WithMedianShift(sums.views, noise_);
    } else {
      noise_.out_of_plane_m = noise_.in_plane_m = std::max(shift_m_, kDecisionShift_m);
    }
    if (!IsEstimated()) noise_.printed = noise_.face = noise_.edges = noise_.rings = 1.0;
    return {};
  }

  // Without the views that are left out.
  Expected<void> Finish() {
    for (std::size_t i = 0; i < left_out_.size(); ++i) {
      if (left_out_[i]) answer_.selection[i].Clear();
    }
    if (!HasShift()) noise_.out_of_plane_m = noise_.in_plane_m = kNoShift_m;
    return Minimise(Residuals(), {}, options_.step_tolerance);
  }

  Expected<void> AddUncertainty() {
    SEXTANT_ASSIGN_OR_RETURN(Sums sums, SumsNow());
    answer_.covariance = std::move(sums.covariance);
    answer_.disagreement = Disagreements(sums.views);
    return {};
  }

  /// Residuals against their expectation at the current state.
  struct Sums {
    Eigen::MatrixXd covariance;  // Covariance of the shared numbers.
    std::vector<ViewSums> views;
    KindSum rings;
  };

  Expected<Sums> SumsNow() {
    const JointLinearisation at = problem_.Linearise();
    const auto covariance = JointCovariance::Of(at);
    if (!covariance) return Undetermined();
    return Sums{covariance->shared(), SumsOf(at, *covariance),
                RingSumOf(model_, problem_.state(), *covariance, noise_.rings)};
  }

  std::vector<bool> LeftOutBy(const std::vector<ViewSums>& sums) const {
    return ContradictingViews(sums, left_out_, options_.cut);
  }

  JointNoise NoiseOf(Sums sums) const {
    for (std::size_t i = 0; i < left_out_.size(); ++i) {
      if (left_out_[i]) sums.views[i] = {};
    }
    JointNoise noise = EstimateNoise(sums.views, sums.rings, noise_, shift_m_);
    noise.out_of_plane_m = std::max(noise.out_of_plane_m, kDecisionShift_m);
    noise.in_plane_m = std::max(noise.in_plane_m, kDecisionShift_m);
    return noise;
  }

  Expected<void> Minimise(const std::vector<BoardViewResiduals>& residuals,
                          const JointLosses& losses, double step_tolerance) {
    const bool any = std::ranges::any_of(answer_.selection, &JointViewSelection::IsUsed);
    if (!any) {
      return MakeError(ErrorCode::kDegenerate,
                       "no view has a board that both sensors see at these poses; give views with "
                       "printed points and returns, or a better start");
    }
    std::vector<JointWeights> weights =
        WeightsOf(model_, problem_.state(), residuals, answer_.selection, noise_, losses);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (left_out_[i]) Unlink(weights[i]);
    }
    problem_.SetWeights(weights, 1.0 / noise_.rings);
    const SchurSteps steps = problem_.Solve(options_.max_iterations, step_tolerance);
    answer_.iterations += steps.count;
    if (steps.converged) return {};
    return MakeError(
        ErrorCode::kNoConvergence,
        fmt::format("no convergence within {} iterations; raise max_iterations, or wrap the inner "
                    "solver in gnc for a better start",
                    options_.max_iterations));
  }

  // A view that is left out keeps its poses by its own observations, so that it can be compared.
  void Unlink(JointWeights& weights) const {
    constexpr double kAnywhere_m = 1.0;
    const double factor = noise_.in_plane_m / kAnywhere_m;
    weights.link *= factor;
    weights.link_factor *= factor;
  }

  const JointModel& model_;
  const JointOptions& options_;
  double shift_m_;
  JointProblem problem_;
  JointNoise noise_;
  std::vector<bool> left_out_;
  JointAnswer answer_;
};

}  // namespace

Expected<JointAnswer> SearchJointly(const JointModel& model, const JointState& start,
                                    double shift_m, const JointOptions& options) {
  return JointSearch(model, start, shift_m, options).Run();
}

}  // namespace sextant
