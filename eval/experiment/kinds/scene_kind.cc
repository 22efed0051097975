// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "eval/experiment/kinds/problem_trials.h"
#include "eval/experiment/kinds/scene_observer.h"
#include "solvers/kernels/kabsch.h"

namespace sextant {
namespace {

struct SceneViewsSettings : SceneSettings, PoseLimits {
  int views = 1;
};

// Metrics after PoseMetrics(), in this order.
enum Extra : int { kKeptPx = kPoseMetricCount, kPairsMm, kMeanMm, kWithoutWorstMm, kBelowKabsch };

const ParameterSet<SceneViewsSettings>& SceneViewsParameters() {
  static const ParameterSet<SceneViewsSettings> set = [] {
    ParameterSet<SceneViewsSettings> options;
    AddPoseLimits(
        AddSceneSettings(options).Count("views", &SceneViewsSettings::views, 1, 1000,
                                        "number of views, each with new poses of the boards"));
    return options;
  }();
  return set;
}

std::vector<Metric> SceneViewsMetrics() {
  std::vector<Metric> metrics = PoseMetrics();
  metrics.push_back({"kept_px", "mean reprojection error of the pairs that the estimate uses"});
  metrics.push_back({"pairs_mm", "RMSE of the 3D-3D pairs, also for solvers that do not use them"});
  metrics.push_back({"mean_mm", "mean distance of the 3D-3D pairs (not the root mean square)"});
  metrics.push_back({"without_worst_mm", "RMSE of the 3D-3D pairs without the worst one"});
  metrics.push_back({"below_kabsch", "1 if pairs_mm is below that of Kabsch on the same pairs"});
  return metrics;
}

void MeasureExtras(const Expected<SolveReport>& report, MetricValues values) {
  if (!report) return;
  const std::vector<double>& px = report->evaluation.per_pair_px;
  double kept = 0.0;
  for (const int i : report->inliers) {
    if (static_cast<std::size_t>(i) < px.size()) kept += px[static_cast<std::size_t>(i)];
  }
  if (!px.empty() && !report->inliers.empty()) {
    values.Set(kKeptPx, kept / static_cast<double>(report->inliers.size()));
  }
}

// Measured on the pairs, whatever the solver used: icp gets no pairs, but its pose has residuals on
// them.
void MeasureDistances(const KnownProblem& known, const Expected<SolveReport>& report,
                      MetricValues values) {
  const auto& pairs = known.problem.pairs_3d3d;
  if (!report || pairs.size() < 2) return;
  double sum = 0.0;
  double squares = 0.0;
  double worst = 0.0;
  for (const Pair3d3d& pair : pairs) {
    const double d = (report->cam_from_lidar * pair.point_in_lidar - pair.point_in_cam).norm();
    sum += d;
    squares += d * d;
    worst = std::max(worst, d);
  }
  const auto count = static_cast<double>(pairs.size());
  values.Set(kPairsMm, 1e3 * std::sqrt(squares / count));
  values.Set(kMeanMm, 1e3 * sum / count);
  values.Set(kWithoutWorstMm,
             1e3 * std::sqrt(std::max(0.0, squares - worst * worst) / (count - 1.0)));
  constexpr double kRounding = 1e-9;
  const PointSets points = PointsOf(pairs);
  const Expected<KabschFit> best = FitKabsch(points.in_cam, points.in_lidar);
  if (best) values.Set(kBelowKabsch, squares < (1.0 - kRounding) * best->sum_squares ? 1.0 : 0.0);
}

Expected<KnownProblem> MakeKnown(const SceneObserver& observer, int views, const TrialId& id) {
  constexpr double kBetweenViews_s = 60.0;
  KnownProblem known;
  known.cam_from_lidar = observer.cam_from_lidar();
  for (int view = 0; view < views; ++view) {
    const std::uint64_t placement_seed =
        DeriveSeed(id.seed, "view", static_cast<std::uint64_t>(view), 0);
    SEXTANT_ASSIGN_OR_RETURN(CalibrationProblem seen,
                             observer.Observe(observer.PlaceBoardsInRoom(placement_seed), id.seed,
                                              view, kBetweenViews_s * view));
    if (view == 0) {
      known.problem = std::move(seen);
      continue;
    }
    CalibrationProblem& all = known.problem;
    all.pairs_3d3d.insert(all.pairs_3d3d.end(), seen.pairs_3d3d.begin(), seen.pairs_3d3d.end());
    all.pairs_2d3d.insert(all.pairs_2d3d.end(), seen.pairs_2d3d.begin(), seen.pairs_2d3d.end());
  }
  known.problem.point_sets = WithholdPairing(known.problem.pairs_3d3d);
  known.problem.initial_cam_from_lidar = observer.DrawStart(id.seed, known.problem.point_sets);
  return known;
}

Expected<TrialsPtr> MakeSceneViewsTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(const SceneViewsSettings settings,
                           SceneViewsParameters().Parse(arguments.parameters));
  SEXTANT_ASSIGN_OR_RETURN(SceneObserver made, SceneObserver::Make(settings, arguments.folder));
  const auto observer = std::make_shared<const SceneObserver>(std::move(made));
  const int views = settings.views;
  return MakeProblemTrials(
      {.make = [observer, views](const TrialId& id) { return MakeKnown(*observer, views, id); },
       .limits = settings,
       .measure_more =
           [](const KnownProblem& known, const Expected<SolveReport>& report, MetricValues values) {
             MeasureExtras(report, values);
             MeasureDistances(known, report, values);
           }},
      arguments.solvers, arguments.condition);
}

}  // namespace

TrialKind SceneKind() {
  return {.name = "scene",
          .summary = "the boards of a scene file, seen by a simulated LiDAR and camera",
          .parameters = SceneViewsParameters().Describe(),
          .metrics = SceneViewsMetrics(),
          .trials_per_block = 10,
          .make = MakeSceneViewsTrials};
}

}  // namespace sextant
