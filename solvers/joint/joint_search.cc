// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_search.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/median.h"

namespace sextant {
namespace {

constexpr int kMaxRounds = 20;
// Tolerance [rad, m] of a minimum that is only the start of the next round.
constexpr double kNearEnough = 1e-4;
constexpr double kRoundTolerance = 1e-6;
// Least shift of the views while outliers among them are unknown.
constexpr double kLooseShift_m = 0.005;
// Fewer views cannot tell which of them is wrong.
constexpr std::ptrdiff_t kMinViews = 3;

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
    if (IsRobust() || options_.cut > 0.0) SEXTANT_RETURN_IF_ERROR(FollowLosses(kNearEnough));
    if (options_.cut > 0.0) {
      SEXTANT_RETURN_IF_ERROR(Cut());
    } else {
      noise_ = {.out_of_plane_m = shift_m_, .in_plane_m = shift_m_};
      SEXTANT_RETURN_IF_ERROR(FollowLosses(options_.step_tolerance));
      if (const auto covariance = JointCovariance::Of(problem_.Linearise())) {
        answer_.covariance = covariance->shared();
      }
    }
    if (answer_.covariance.size() == 0) return Undetermined();
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
      answer_.selection = SelectWithin(model_, residuals, noise_, kAll);
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

  Expected<void> Cut() {
    SEXTANT_RETURN_IF_ERROR(LeaveOutViews());
    bool settled = false;
    for (int round = 0; round < kMaxRounds; ++round) {
      const std::vector<BoardViewResiduals> residuals = Residuals();
      JointSelection within = SelectWithin(model_, residuals, noise_, options_.cut);
      for (std::size_t i = 0; i < within.size(); ++i) {
        if (left_out_[i]) within[i].Clear();
      }
      const bool same = within == answer_.selection;
      const bool is_last = settled && same;
      answer_.selection = std::move(within);
      const double tolerance = is_last ? options_.step_tolerance : kRoundTolerance;
      SEXTANT_RETURN_IF_ERROR(
          Minimise(residuals, {}, std::max(tolerance, options_.step_tolerance)));
      const JointLinearisation at = problem_.Linearise();
      const auto covariance = JointCovariance::Of(at);
      if (!covariance) return Undetermined();
      answer_.covariance = covariance->shared();
      if (is_last) break;
      const JointNoise before = noise_;
      const std::vector<ViewSums> sums = SumsOf(at, *covariance);
      const bool left_out = HasShift() && LeaveOut(sums);
      if (IsEstimated()) noise_ = EstimateNoise(sums, before, shift_m_);
      settled = same && !left_out && IsSameNoise(noise_, before);
    }
    return {};
  }

  // Views that contradict the others, from the minimum of the losses with its loose shift.
  Expected<void> LeaveOutViews() {
    const JointLinearisation at = problem_.Linearise();
    const auto covariance = JointCovariance::Of(at);
    if (!covariance) return Undetermined();
    const std::vector<ViewSums> sums = SumsOf(at, *covariance);
    if (HasShift()) {
      const JointNoise loose = noise_;
      noise_ = WithMedianShift(sums, loose);
      const double scale = noise_.in_plane_m / loose.in_plane_m;
      LeaveOut(sums, scale * scale);
    } else {
      LeaveOut(sums);
      noise_.out_of_plane_m = noise_.in_plane_m = kNoShift_m;
    }
    if (!IsEstimated()) {
      noise_ = {.out_of_plane_m = shift_m_, .in_plane_m = shift_m_};
    }
    return {};
  }

  // Leaves out the views beyond `cut`, all within a factor of two of the worst: one that is wrong
  // makes others appear so. True where there was one.
  bool LeaveOut(const std::vector<ViewSums>& sums, double scale = 1.0) {
    constexpr double kAlike = 0.5;
    const auto ratio = [&](const ViewSums& of) {
      if (of.freedom == 0) return 0.0;
      const double limit = std::sqrt(of.freedom) + options_.cut * std::sqrt(0.5);
      return of.contradiction / (std::max(scale, 1e-6) * limit * limit);
    };
    double worst = 1.0;
    std::ptrdiff_t seen = 0;
    for (const ViewSums& of : sums) {
      worst = std::max(worst, ratio(of));
      seen += of.freedom > 0 ? 1 : 0;
    }
    if (worst <= 1.0 || seen < kMinViews) return false;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      if (ratio(sums[i]) > std::max(1.0, kAlike * worst)) left_out_[i] = true;
    }
    return true;
  }

  Expected<void> Minimise(const std::vector<BoardViewResiduals>& residuals,
                          const JointLosses& losses, double step_tolerance) {
    const bool any = std::ranges::any_of(answer_.selection, &JointViewSelection::IsUsed);
    if (!any) {
      return MakeError(ErrorCode::kDegenerate,
                       "no view has a board that both sensors see at these poses; give views with "
                       "printed points and returns, or a better start");
    }
    problem_.SetWeights(
        WeightsOf(model_, problem_.state(), residuals, answer_.selection, noise_, losses));
    const JointSteps steps = problem_.Solve(options_.max_iterations, step_tolerance);
    answer_.iterations += steps.count;
    if (steps.converged) return {};
    return MakeError(
        ErrorCode::kNoConvergence,
        fmt::format("no convergence within {} iterations; raise max_iterations, or wrap the inner "
                    "solver in gnc for a better start",
                    options_.max_iterations));
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
