// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>

#include "base/units.h"
#include "eval/experiment/definition/trials.h"
#include "eval/experiment/kinds/scene_observer.h"
#include "solvers/averaging/average.h"
#include "solvers/kernels/kabsch.h"

namespace sextant {
namespace {

struct SceneAverageSettings : SceneSettings {
  int scans = 100;
  double interval_s = 0.1;
};

enum SceneAverageMeasured : int {
  kAverageTranslationMm,
  kAverageRotationDeg,
  kAverageXM,
  kAverageYM,
  kAverageZM
};

const std::vector<Metric>& SceneAverageMetrics() {
  static const std::vector<Metric> metrics = {
      {"translation_mm", "distance of the averaged translation from the truth"},
      {"rotation_deg", "angle between the averaged and the true rotation"},
      {"x_m", "x of the averaged translation"},
      {"y_m", "y of the averaged translation"},
      {"z_m", "z of the averaged translation"},
  };
  return metrics;
}

const ParameterSet<SceneAverageSettings>& SceneAverageParameters() {
  static const ParameterSet<SceneAverageSettings> set = [] {
    ParameterSet<SceneAverageSettings> options;
    AddSceneSettings(options)
        .Count("scans", &SceneAverageSettings::scans, 1, 10'000,
               "number of scans; rows are written after 1, 2, 3, 5, 7, 10 ... of them")
        .Real("interval_s", &SceneAverageSettings::interval_s, "s", 0.0, 1e6,
              "time from one scan to the next");
    return options;
  }();
  return set;
}

// 1, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70, 100 and so on.
bool IsReported(int scans) {
  int digits = scans;
  while (digits >= 100 && digits % 10 == 0) digits /= 10;
  for (const int step : {1, 2, 3, 5, 7, 10, 15, 20, 30, 50, 70}) {
    if (digits == step) return true;
  }
  return false;
}

class AverageTrials final : public Trials {
 public:
  AverageTrials(SceneObserver observer, const SceneAverageSettings& settings)
      : observer_(std::move(observer)), scans_(settings.scans), interval_s_(settings.interval_s) {}

  const std::vector<std::string>& subjects() const override {
    static const std::vector<std::string> names = {"true mean", "original's running average",
                                                   "kabsch of all pairs", "one scan / sqrt(N)"};
    return names;
  }

  // Boards and sensors do not move within a trial, so only noise is averaged.
  void Run(const TrialId& id, TrialRows& rows) const override {
    const Scene scene = observer_.PlaceBoardsInRoom(id.seed);
    std::vector<Rigid3d> answers;
    std::vector<Eigen::Vector3d> in_cam;
    std::vector<Eigen::Vector3d> in_lidar;
    for (int scan = 0; scan < scans_; ++scan) {
      const Expected<CalibrationProblem> seen =
          observer_.Observe(scene, id.seed, scan, interval_s_ * scan);
      if (!seen) continue;
      const PointSets points = PointsOf(seen->pairs_3d3d);
      const Expected<KabschFit> fit = FitKabsch(points.in_cam, points.in_lidar);
      if (!fit) continue;
      answers.push_back(fit->b_from_a);
      in_cam.insert(in_cam.end(), points.in_cam.begin(), points.in_cam.end());
      in_lidar.insert(in_lidar.end(), points.in_lidar.begin(), points.in_lidar.end());
      const int count = static_cast<int>(answers.size());
      if (!IsReported(count)) continue;
      int subject = 0;
      for (const RotationAverage kind :
           {RotationAverage::kChordal, RotationAverage::kOriginalRunning}) {
        Measure(AveragePoses(answers, kind), rows.Add(subject++, count));
      }
      Measure(FitKabsch(in_cam, in_lidar).map([](const KabschFit& all) { return all.b_from_a; }),
              rows.Add(subject++, count));
      MeasureIdeal(answers[0], count, rows.Add(subject, count));
    }
  }

 private:
  // The first scan's error divided by sqrt(N), as if all of it were noise.
  void MeasureIdeal(const Rigid3d& first, int scans, MetricValues values) const {
    const PoseDistance error = DistanceBetween(first, observer_.cam_from_lidar());
    values.Set(kAverageTranslationMm, 1e3 * error.translation_m / std::sqrt(scans));
    values.Set(kAverageRotationDeg, kDegPerRad * error.rotation_rad / std::sqrt(scans));
  }

  void Measure(const Expected<Rigid3d>& pose, MetricValues values) const {
    if (!pose) return;
    const PoseDistance error = DistanceBetween(*pose, observer_.cam_from_lidar());
    values.Set(kAverageTranslationMm, 1e3 * error.translation_m);
    values.Set(kAverageRotationDeg, kDegPerRad * error.rotation_rad);
    values.Set(kAverageXM, pose->translation.x());
    values.Set(kAverageYM, pose->translation.y());
    values.Set(kAverageZM, pose->translation.z());
  }

  SceneObserver observer_;
  int scans_;
  double interval_s_;
};

Expected<TrialsPtr> MakeSceneAverageTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(const SceneAverageSettings settings,
                           SceneAverageParameters().Parse(arguments.parameters));
  SEXTANT_ASSIGN_OR_RETURN(SceneObserver observer, SceneObserver::Make(settings, arguments.folder));
  return std::make_shared<AverageTrials>(std::move(observer), settings);
}

}  // namespace

TrialKind SceneAverageKind() {
  return {.name = "scene_average",
          .summary = "the estimates of many scans of one session, averaged in four ways",
          .takes_solvers = false,
          .parameters = SceneAverageParameters().Describe(),
          .metrics = SceneAverageMetrics(),
          .trials_per_block = 1,
          .make = MakeSceneAverageTrials};
}

}  // namespace sextant
