// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/kinds/real_data.h"
#include "eval/experiment/kinds/real_trials.h"
#include "io/cameras/camera_file.h"
#include "io/problems/read_problem.h"

namespace sextant {
namespace {

void ScaleToMetres(double metres, CalibrationProblem& problem) {
  for (Pair3d3d& pair : problem.pairs_3d3d) {
    pair.point_in_cam *= metres;
    pair.point_in_lidar *= metres;
    pair.sigma_m *= metres;
    if (pair.covariance_in_cam) *pair.covariance_in_cam *= metres * metres;
  }
  for (Pair2d3d& pair : problem.pairs_2d3d) pair.point_in_lidar *= metres;
}

Expected<TrialsPtr> MakeRealPairsTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(const RealSettings settings,
                           RealParameters().Parse(arguments.parameters));
  SEXTANT_ASSIGN_OR_RETURN(const RealDataSet set,
                           OpenRealData(settings.manifest, arguments.folder));
  const DataManifest& manifest = set.manifest;
  if (manifest.pairs.empty()) {
    return MakeError(ErrorCode::kInvalidInput,
                     manifest.name + " has images and scans: use the kind real_views");
  }
  SEXTANT_ASSIGN_OR_RETURN(const DetectedProblem read, ReadProblem(set.Find(manifest.pairs)));
  CalibrationProblem problem = read.problem;
  if (!manifest.camera.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const Camera camera, ReadCamera(set.Find(manifest.camera)));
    problem.camera = camera;
  }
  if (manifest.lidar_first) {
    for (Pair3d3d& pair : problem.pairs_3d3d) std::swap(pair.point_in_cam, pair.point_in_lidar);
  }
  ScaleToMetres(manifest.metres, problem);
  problem.point_sets = {};
  SEXTANT_ASSIGN_OR_RETURN(std::vector<SolverPtr> solvers, SolversFor(problem, arguments.solvers));
  return MakeRealTrials(std::move(problem), manifest.reference, settings, std::move(solvers),
                        arguments.condition);
}

}  // namespace

TrialKind RealPairsKind() {
  return {.name = "real_pairs",
          .summary = "correspondences of a real data set, resampled",
          .skips_absent_data = true,
          .parameters = RealParameters().Describe(),
          .metrics = RealMetrics(),
          .make = MakeRealPairsTrials};
}

}  // namespace sextant
