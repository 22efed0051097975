// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/rig_search.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace sextant {
namespace {

constexpr int kMaxLossRounds = 15;
constexpr int kMaxCutRounds = 12;
constexpr double kLossScale = 3.0;
constexpr double kNoLoss = std::numeric_limits<double>::infinity();
// Tolerances [rad, m] of minima that are only the start of the next round.
constexpr double kCoarse = 1e-4;
constexpr double kFine = 1e-6;
// Least shift of the views while outliers among them are unknown.
constexpr double kLooseShift_m = 0.005;
// A view whose returns are shifted by more than this multiple of the usual shift, in root mean
// square, contradicts the others.
constexpr double kMaxShift = 3.0;

class RigSearch {
 public:
  RigSearch(const RigModel& model, const RigState& start, const RigOptions& options)
      : model_(model),
        options_(options),
        minimum_(model, options.root, start),
        counter_(options.progress, "rig", kMaxLossRounds + kMaxCutRounds + 1) {
    for (const RigBlock& block : model.blocks) {
      answer_.selection.emplace_back(static_cast<std::size_t>(block.units), true);
    }
  }

  Expected<RigAnswer> Run() {
    SEXTANT_RETURN_IF_ERROR(FollowLoss());
    CountTo(kMaxLossRounds);
    for (auto& levels : answer_.noise) {
      for (double& level : levels) level = std::max(level, 1.0);
    }
    SEXTANT_RETURN_IF_ERROR(Cut());
    CountTo(kMaxLossRounds + kMaxCutRounds);
    ClearAbsentShifts(model_, answer_.noise);
    SEXTANT_RETURN_IF_ERROR(Minimise(kNoLoss, options_.step_tolerance));
    const auto information = RigInformationOf(minimum_.Linearise());
    if (!information) return Undetermined();
    answer_.covariance = information->covariance;
    answer_.state = minimum_.state();
    answer_.units = Units();
    counter_.Finish();
    return std::move(answer_);
  }

 private:
  // Rounds that are not needed count as done.
  void CountTo(int rounds) {
    for (; rounds_ < rounds; ++rounds_) counter_.Step();
  }

  static tl::unexpected<Error> Undetermined() {
    return MakeError(ErrorCode::kDegenerate,
                     "the views leave a direction of a sensor's pose undetermined; record boards "
                     "at more positions and tilts");
  }

  RigUnits Units() const { return UnitsAt(model_, minimum_.state()); }

  // Iteratively reweighted least squares. The noise starts at what an inaccurate start leaves, and
  // becomes smaller as the poses improve.
  Expected<void> FollowLoss() {
    for (int round = 0; round < kMaxLossRounds; ++round) {
      const std::vector<Rigid3d> before = minimum_.state().sensor_from_root;
      answer_.noise = MedianLevels(model_, minimum_.state(), Units(), kLooseShift_m);
      const Expected<void> ok = Minimise(kLossScale, kCoarse);
      if (!ok && ok.error().code != ErrorCode::kNoConvergence) return ok;
      double step = 0.0;
      for (std::size_t s = 0; s < before.size(); ++s) {
        const auto& now = minimum_.state().sensor_from_root[s];
        step = std::max(step, PoseDifference(now, before[s]).norm());
      }
      if (step < 5.0 * kCoarse) break;
    }
    answer_.noise = MedianLevels(model_, minimum_.state(), Units(), 0.0);
    return {};
  }

  Expected<void> Cut() {
    for (int round = 0; round < kMaxCutRounds; ++round) {
      const RigSelection before = answer_.selection;
      Select();
      SEXTANT_RETURN_IF_ERROR(Minimise(kNoLoss, std::max(kFine, options_.step_tolerance)));
      const RigLinearisation at = minimum_.Linearise();
      const auto information = RigInformationOf(at);
      if (!information) return Undetermined();
      const RigNoise noise = EstimatedLevels(model_, at, *information, answer_.noise);
      const bool settled = before == answer_.selection && IsSameLevels(noise, answer_.noise);
      answer_.noise = noise;
      if (settled) break;
    }
    return {};
  }

  // An observation is left out as a whole where most of it is, or where its shift is.
  void Select() {
    const RigUnits units = Units();
    std::map<std::pair<std::size_t, std::size_t>, std::pair<int, int>> kept;
    for (std::size_t k = 0; k < units.size(); ++k) {
      const RigBlock& block = model_.blocks[k];
      const double limit = UnitLimit(block.rows_per_unit, options_.cut) *
                           LevelOf(answer_.noise, block.sensor, block.kind);
      auto& [used, all] = kept[{block.placement, block.seen}];
      for (std::size_t i = 0; i < units[k].size(); ++i) {
        answer_.selection[k][i] = units[k][i] < limit;
        used += answer_.selection[k][i] ? block.rows_per_unit : 0;
        all += block.rows_per_unit;
      }
    }
    for (std::size_t k = 0; k < units.size(); ++k) {
      const RigBlock& block = model_.blocks[k];
      const auto& [used, all] = kept[{block.placement, block.seen}];
      if (2 * used >= all && !IsShifted(block)) continue;
      answer_.selection[k].assign(answer_.selection[k].size(), false);
    }
  }

  // Without its returns, a view has no shift: what was left out once for it stays out. A shift is
  // as large as the level allowed with which it was estimated, which may have become smaller since.
  bool IsShifted(const RigBlock& block) {
    const int shift = model_.placements[block.placement].shift_of[block.seen];
    if (shift < 0) return false;
    if (shifted_.contains({block.placement, block.seen})) return true;
    const auto s = static_cast<std::size_t>(shift);
    const RigShift& of = model_.placements[block.placement].shifts[s];
    const Vector6d at = ShiftAt(model_, minimum_.state(), block.placement, s);
    double squares = 0.0;
    for (int k = 0; k < 6; ++k) {
      const bool out = kShiftIsOutOfPlane[static_cast<std::size_t>(k)];
      const double level =
          LevelOf(minimised_with_, of.sensor, out ? RigKind::kShiftOut : RigKind::kShiftIn);
      squares += std::pow(at[k] / (level * of.sigma_m), 2);
    }
    if (squares < 6.0 * kMaxShift * kMaxShift) return false;
    shifted_[{block.placement, block.seen}] = true;
    return true;
  }

  Expected<void> Minimise(double loss_scale, double tolerance) {
    minimum_.SetWeights(WeightsFor(model_, minimum_.state(), Units(), answer_.selection,
                                   answer_.noise, loss_scale));
    const SchurSteps steps = minimum_.Solve(options_.max_iterations, tolerance);
    minimised_with_ = answer_.noise;
    answer_.iterations += steps.count;
    CountTo(rounds_ + 1);
    if (steps.converged) return {};
    return MakeError(ErrorCode::kNoConvergence,
                     fmt::format("no convergence within {} iterations; do the observations belong "
                                 "to the boards and the moments that they are listed under?",
                                 options_.max_iterations));
  }

  const RigModel& model_;
  const RigOptions& options_;
  RigMinimum minimum_;
  RigNoise minimised_with_;
  std::map<std::pair<std::size_t, std::size_t>, bool> shifted_;
  ProgressCounter counter_;
  int rounds_ = 0;
  RigAnswer answer_;
};

}  // namespace

Expected<RigAnswer> SearchRig(const RigModel& model, const RigState& start,
                              const RigOptions& options) {
  return RigSearch(model, start, options).Run();
}

}  // namespace sextant
