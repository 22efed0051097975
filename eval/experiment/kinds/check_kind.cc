// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <mutex>
#include <optional>

#include "base/random.h"
#include "base/units.h"
#include "calibrate/scene/pose_check.h"
#include "eval/experiment/definition/parameter_set.h"
#include "eval/experiment/definition/trials.h"
#include "eval/experiment/kinds/scene_pool.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

struct PoseCheckSettings {
  std::string place = "street";
  std::string lidar_model{};
  int pool = 24;
  int pairs = 10;
  double offset_deg = 0.0;
  double offset_mm = 0.0;
  double detect_deg = 0.5;
  double detect_mm = 80.0;
};

enum PoseCheckMeasured : int {
  kValidState,
  kMovedState,
  kUnknownState,
  kPValue,
  kPoseOffDeg,
  kPoseOffMm,
  kPoseNees,
};

std::vector<Metric> PoseCheckMetrics() {
  return {
      {"valid", "1 if the answer is still valid"},
      {"moved", "1 if the answer is moved"},
      {"unknown", "1 if the answer is cannot tell"},
      {"p_value",
       "probability of a change that is as far in its sigmas, if the pose had not moved; 1 where "
       "the change is unknown"},
      {"rotation_deg", "error of the measured pose's rotation"},
      {"translation_mm", "error of the measured pose's translation"},
      {"nees",
       "normalised estimation error squared of the measured pose, over 6 degrees of freedom"},
  };
}

const ParameterSet<PoseCheckSettings>& PoseCheckParameters() {
  static const ParameterSet<PoseCheckSettings> set =
      ParameterSet<PoseCheckSettings>()
          .Text("place", &PoseCheckSettings::place, "name", "room or street")
          .Text("lidar_model", &PoseCheckSettings::lidar_model, "name",
                "see sextant list lidars; empty: that of the place")
          .Count("pool", &PoseCheckSettings::pool, 1, 1000,
                 "number of scenes that are simulated; every trial draws some of them")
          .Count("pairs", &PoseCheckSettings::pairs, 1, 1000, "number of pairs of a check")
          .Real("offset_deg", &PoseCheckSettings::offset_deg, "deg", 0.0, 10.0,
                "by which the given pose is off, about a random axis")
          .Real("offset_mm", &PoseCheckSettings::offset_mm, "mm", 0.0, 1000.0,
                "by which it is off along a random axis")
          .Real("detect_deg", &PoseCheckSettings::detect_deg, "deg", 0.001, 10.0,
                "the rotation of --detect")
          .Real("detect_mm", &PoseCheckSettings::detect_mm, "mm", 0.1, 1000.0,
                "the translation of --detect");
  return set;
}

// The tail of the chi-square distribution with 6 degrees of freedom, in closed form.
double ProbabilityAbove(double squared_distance) {
  const double half = 0.5 * squared_distance;
  return std::exp(-half) * (1.0 + half + 0.5 * half * half);
}

class PoseCheckTrials final : public Trials {
 public:
  PoseCheckTrials(PoseCheckSettings settings, EverydayPlace place)
      : settings_(std::move(settings)), place_(place) {}

  const std::vector<std::string>& subjects() const override { return subjects_; }

  void Run(const TrialId& id, TrialRows& rows) const override {
    // Scenes take seconds each, and reading an experiment file should not.
    std::call_once(made_,
                   [this] { pool_ = PoolOf(place_, settings_.lidar_model, settings_.pool); });
    MetricValues values = rows.Add(0);
    for (const int state : {kValidState, kMovedState, kUnknownState}) values.Set(state, 0.0);
    if (!pool_) return;
    Random random(DeriveSeed(id.seed, "check", 0, 0));
    std::vector<int> chosen(static_cast<std::size_t>(settings_.pairs));
    random.Sample(settings_.pool, chosen);
    std::vector<ScenePair> pairs;
    for (const int i : chosen) pairs.push_back((*pool_)->pairs[static_cast<std::size_t>(i)]);
    Measure(pairs, GivenPose(random), values);
  }

 private:
  Rigid3d GivenPose(Random& random) const {
    Vector6d delta;
    for (int i = 0; i < 6; ++i) delta(i) = random.Normal();
    delta.head<3>() *= settings_.offset_deg * kRadPerDeg / delta.head<3>().norm();
    delta.tail<3>() *= 1e-3 * settings_.offset_mm / delta.tail<3>().norm();
    return Perturb((*pool_)->cam_from_lidar, delta);
  }

  void Measure(const std::vector<ScenePair>& pairs, const Rigid3d& given,
               MetricValues values) const {
    const SceneFit fit = SearchScenes(pairs, given);
    const CheckLimits limits{.rotation_rad = settings_.detect_deg * kRadPerDeg,
                             .translation_m = 1e-3 * settings_.detect_mm};
    const PoseCheck check = CheckScenes(fit, given, limits);
    values.Set(check.state == PoseState::kValid   ? kValidState
               : check.state == PoseState::kMoved ? kMovedState
                                                  : kUnknownState,
               1.0);
    const bool is_clear = WhyUnclear(fit).empty() && WrongIntrinsics(fit).empty();
    values.Set(kPValue, is_clear ? ProbabilityAbove(DistanceOfChange(fit, given)) : 1.0);
    if (!is_clear) return;
    const Rigid3d& truth = (*pool_)->cam_from_lidar;
    const PoseDistance off = DistanceBetween(fit.cam_from_lidar, truth);
    values.Set(kPoseOffDeg, off.rotation_rad / kRadPerDeg);
    values.Set(kPoseOffMm, 1e3 * off.translation_m);
    values.Set(
        kPoseNees,
        SquaredMahalanobis<6>(PoseDifference(fit.cam_from_lidar, truth), fit.covariance) / 6.0);
  }

  PoseCheckSettings settings_;
  EverydayPlace place_;
  std::vector<std::string> subjects_ = {"check"};
  mutable std::once_flag made_;
  mutable Expected<std::shared_ptr<const ScenePool>> pool_;
};

Expected<TrialsPtr> MakePoseCheckTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(PoseCheckSettings settings,
                           PoseCheckParameters().Parse(arguments.parameters));
  const std::optional<EverydayPlace> place = FindEverydayPlace(settings.place);
  if (!place) {
    return MakeError(ErrorCode::kUnknownName,
                     "place: " + settings.place + " is unknown: expected room or street");
  }
  if (!settings.lidar_model.empty()) {
    if (const auto known = FindLidarModel(settings.lidar_model); !known) {
      return tl::unexpected<Error>(known.error());
    }
  }
  if (settings.pairs > settings.pool) {
    return MakeError(ErrorCode::kInvalidOption,
                     "pairs: expected at most as many as the pool has scenes");
  }
  return std::make_shared<PoseCheckTrials>(std::move(settings), *place);
}

}  // namespace

TrialKind CheckKind() {
  return {.name = "check",
          .summary = "sextant check on simulated everyday scenes, with a pose that is off or not",
          .takes_solvers = false,
          .parameters = PoseCheckParameters().Describe(),
          .metrics = PoseCheckMetrics(),
          .trials_per_block = 10,
          .make = MakePoseCheckTrials};
}

}  // namespace sextant
