// SPDX-License-Identifier: Apache-2.0
#include <tbb/collaborative_call_once.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "base/units.h"
#include "eval/experiment/definition/trials.h"
#include "eval/experiment/kinds/pose_graph.h"
#include "eval/experiment/kinds/scene_observer.h"
#include "eval/experiment/kinds/stereo_scene.h"
#include "eval/metrics/cloud_fusion.h"
#include "solvers/averaging/average.h"
#include "solvers/kernels/kabsch.h"

namespace sextant {
namespace {

constexpr int kComparedPoints = 4000;

struct FusionSettings : SceneSettings {
  int scans = 10;
  double tape_m = 0.01;
  double tape_deg = 2.0;
};

enum FusionMeasured : int { kFusedTranslationMm, kFusedRotationDeg, kCloudMm, kWallMm, kCheckerMm };

const std::vector<Metric>& FusionMetrics() {
  static const std::vector<Metric> metrics = {
      {"translation_mm", "translation error of cam2_from_cam1"},
      {"rotation_deg", "rotation error of cam2_from_cam1"},
      {"cloud_mm", "median distance of the first stereo cloud from the surfaces of the second"},
      {"wall_mm", "distance between the two clouds on a wall, RMS over the walls"},
      {"checker_mm", "distance between the mean checkerboard corners of the two stereo cameras"},
  };
  return metrics;
}

const ParameterSet<FusionSettings>& FusionParameters() {
  static const ParameterSet<FusionSettings> set = [] {
    ParameterSet<FusionSettings> options;
    AddSceneSettings(options)
        .Count("scans", &FusionSettings::scans, 1, 1000,
               "number of scans of one placement whose estimates are averaged")
        .Real("tape_m", &FusionSettings::tape_m, "m", 0.0, 1.0,
              "standard error of a tape measurement, per axis of each camera's position")
        .Real("tape_deg", &FusionSettings::tape_deg, "deg", 0.0, 45.0,
              "standard error of an angle computed from tape measurements");
    return options;
  }();
  return set;
}

// What the stereo cameras of a scene see, rendered when it is first needed: a second per image, the
// largest part of an experiment of few trials.
class StereoRendering {
 public:
  explicit StereoRendering(Scene scene) : scene_(std::move(scene)) {}

  const Expected<StereoPair>& Get() {
    // Not std::call_once: rendering is parallel, and its thread may take another trial meanwhile.
    tbb::collaborative_call_once(rendered_, [this] {
      pair_ = RenderStereoPair(scene_);
      if (pair_) second_.emplace(pair_->clouds[1]);
    });
    return pair_;
  }

  // The cloud of the second camera, once it is there.
  const ReferenceCloud& second() const { return *second_; }

 private:
  Scene scene_;
  tbb::collaborative_once_flag rendered_;
  Expected<StereoPair> pair_ = MakeError(ErrorCode::kMissingData, "not rendered yet");
  std::optional<ReferenceCloud> second_;
};

// Conditions of an experiment that differ in what is measured of the boards share one rendering.
std::shared_ptr<StereoRendering> RenderingOf(const SceneObserver& observer,
                                             const std::filesystem::path& folder) {
  static std::mutex mutex;
  static std::map<std::tuple<std::string, std::string, double>, std::weak_ptr<StereoRendering>>
      renderings;
  const SceneSettings& settings = observer.settings();
  const std::lock_guard lock(mutex);
  std::weak_ptr<StereoRendering>& known =
      renderings[{(folder / settings.scene).string(), settings.camera_model, settings.board_scale}];
  std::shared_ptr<StereoRendering> rendering = known.lock();
  if (!rendering) known = rendering = std::make_shared<StereoRendering>(observer.whole_scene());
  return rendering;
}

// cam1 and cam2 never see the same board: each is calibrated to the LiDAR, and the pose graph joins
// them.
class FusionTrials final : public Trials {
 public:
  FusionTrials(SceneObserver first, SceneObserver second, const FusionSettings& settings,
               std::shared_ptr<StereoRendering> rendering)
      : observers_{std::move(first), std::move(second)},
        settings_(settings),
        rendering_(std::move(rendering)) {}

  const std::vector<std::string>& subjects() const override {
    static const std::vector<std::string> names = {"truth", "tape", "pipeline, one scan",
                                                   "pipeline, scans averaged"};
    return names;
  }

  void Run(const TrialId& id, TrialRows& rows) const override {
    const Rigid3d truth = observers_[1].cam_from_lidar() * observers_[0].cam_from_lidar().Inverse();
    Measure(truth, truth, rows.Add(0));
    Measure(ByTape(id.seed), truth, rows.Add(1));
    Measure(ByPipeline(id.seed, 1), truth, rows.Add(2));
    Measure(ByPipeline(id.seed, settings_.scans), truth, rows.Add(3));
  }

 private:
  Expected<Rigid3d> ByTape(std::uint64_t seed) const {
    Random random(DeriveSeed(seed, "tape", 0, 0));
    std::array<Rigid3d, 2> cam_from_lidar;
    for (std::size_t i = 0; i < 2; ++i) {
      Vector6d delta;
      for (int k = 0; k < 6; ++k) {
        delta[k] = (k < 3 ? kRadPerDeg * settings_.tape_deg : settings_.tape_m) * random.Normal();
      }
      cam_from_lidar[i] = Perturb(observers_[i].cam_from_lidar(), delta);
    }
    return cam_from_lidar[1] * cam_from_lidar[0].Inverse();
  }

  Expected<UncertainPose> Calibrate(const SceneObserver& observer, std::uint64_t seed,
                                    int scans) const {
    constexpr double kBetweenScans_s = 0.1;
    const Scene scene = observer.PlaceBoardsInRoom(seed);
    std::vector<Rigid3d> answers;
    for (int scan = 0; scan < scans; ++scan) {
      const Expected<CalibrationProblem> seen =
          observer.Observe(scene, seed, scan, kBetweenScans_s * scan);
      if (!seen) continue;
      const PointSets points = PointsOf(seen->pairs_3d3d);
      const Expected<KabschFit> fit = FitKabsch(points.in_cam, points.in_lidar);
      if (fit) answers.push_back(fit->b_from_a);
    }
    SEXTANT_ASSIGN_OR_RETURN(const Rigid3d mean, AveragePoses(answers, RotationAverage::kChordal));
    // Without a loop the weights do not matter: any covariance gives the same result.
    return UncertainPose{mean, 1e-6 * Matrix6d::Identity()};
  }

  Expected<Rigid3d> ByPipeline(std::uint64_t seed, int scans) const {
    std::vector<PoseEdge> edges;
    for (std::size_t i = 0; i < 2; ++i) {
      SEXTANT_ASSIGN_OR_RETURN(const UncertainPose pose, Calibrate(observers_[i], seed, scans));
      edges.push_back({.from = "lidar", .to = i == 0 ? "cam1" : "cam2", .to_from = pose});
    }
    SEXTANT_ASSIGN_OR_RETURN(const SensorGraph graph, SensorGraph::Solve(edges));
    return graph.Between("cam2", "cam1").map([](const UncertainPose& p) { return p.b_from_a; });
  }

  void Measure(const Expected<Rigid3d>& cam2_from_cam1, const Rigid3d& truth,
               MetricValues values) const {
    if (!cam2_from_cam1) return;
    const PoseDistance error = DistanceBetween(*cam2_from_cam1, truth);
    values.Set(kFusedTranslationMm, 1e3 * error.translation_m);
    values.Set(kFusedRotationDeg, error.rotation_rad / kRadPerDeg);
    const Expected<StereoPair>& pair = rendering_->Get();
    if (!pair) return;
    values.Set(kCloudMm, 1e3 * CompareClouds(pair->clouds[0], *cam2_from_cam1, rendering_->second(),
                                             {.max_points = kComparedPoints})
                                   .median_m);
    values.Set(kWallMm, 1e3 * WallOffset(*pair, *cam2_from_cam1));
    values.Set(kCheckerMm, 1e3 * CheckerOffset(*pair, *cam2_from_cam1));
  }

  std::array<SceneObserver, 2> observers_;
  FusionSettings settings_;
  std::shared_ptr<StereoRendering> rendering_;
};

Expected<TrialsPtr> MakeFusionTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(const FusionSettings settings,
                           FusionParameters().Parse(arguments.parameters));
  if (!settings.translation_m.empty() || !settings.rotation_deg.empty()) {
    return MakeError(
        ErrorCode::kInvalidOption,
        "the scene gives the poses of both cameras; leave out translation_m and rotation_deg");
  }
  SEXTANT_ASSIGN_OR_RETURN(SceneObserver first, SceneObserver::Make(settings, arguments.folder, 0));
  SEXTANT_ASSIGN_OR_RETURN(SceneObserver second,
                           SceneObserver::Make(settings, arguments.folder, 1));
  std::shared_ptr<StereoRendering> rendering = RenderingOf(first, arguments.folder);
  return std::make_shared<FusionTrials>(std::move(first), std::move(second), settings,
                                        std::move(rendering));
}

}  // namespace

TrialKind FusionKind() {
  return {.name = "fusion",
          .summary =
              "two stereo cameras joined through the LiDAR: their clouds fused with poses measured "
              "by tape and estimated by the pipeline",
          .takes_solvers = false,
          .parameters = FusionParameters().Describe(),
          .metrics = FusionMetrics(),
          .trials_per_block = 5,
          .make = MakeFusionTrials};
}

}  // namespace sextant
