// SPDX-License-Identifier: Apache-2.0
#include "eval/accuracy_study.h"

#include <atomic>
#include <cmath>
#include <thread>

#include "eval/bounds.h"
#include "eval/mismatched_pairs.h"

namespace sextant {
namespace {

struct Trial {
  bool answered = false;
  PoseDistance error;
  RmsError bound;
};

// What the solver may see: its own kind of data and nothing else.
CalibrationProblem ViewOf(const CalibrationProblem& problem, const SolverSpec& spec) {
  CalibrationProblem view;
  view.camera = problem.camera;
  if (spec.needs.pairs_3d3d > 0) view.pairs_3d3d = problem.pairs_3d3d;
  if (spec.needs.pairs_2d3d > 0) view.pairs_2d3d = problem.pairs_2d3d;
  if (spec.needs.points_per_set > 0) view.point_sets = problem.point_sets;
  return view;
}

Trial RunTrial(const RandomScene& scene, const CalibrationProblem& problem, int inliers,
               const Solver& solver) {
  CalibrationProblem view = ViewOf(problem, solver.spec());
  if (solver.spec().needs.initial_pose) view.initial_cam_from_lidar = scene.cam_from_lidar;
  CalibrationProblem clean = ViewOf(scene.problem, solver.spec());
  const auto count = static_cast<std::size_t>(inliers);
  if (!clean.pairs_3d3d.empty()) clean.pairs_3d3d.resize(count);
  if (!clean.pairs_2d3d.empty()) clean.pairs_2d3d.resize(count);
  // Unpaired points can at best be paired rightly.
  if (solver.spec().needs.points_per_set > 0) clean.pairs_3d3d = scene.problem.pairs_3d3d;

  Trial trial;
  const Expected<Matrix6d> bound = CramerRaoBound(clean, scene.cam_from_lidar);
  const Expected<SolveReport> report = solver.Solve(view);
  trial.answered = bound.has_value() && report.has_value();
  if (!trial.answered) return trial;
  trial.bound = RmsOf(*bound);
  trial.error = DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar);
  return trial;
}

AccuracyResult Summarise(const std::string& solver, const std::string& condition,
                         std::span<const Trial> trials) {
  AccuracyResult result{.solver = solver, .condition = condition};
  int counted = 0;
  for (const Trial& trial : trials) {
    ++result.trials;
    if (!trial.answered) {
      ++result.unanswered;
      continue;
    }
    if (trial.error.rotation_rad > kGrossRotation) {
      ++result.gross;
      continue;
    }
    ++counted;
    const auto square = [](double x) { return x * x; };
    result.rotation_rad += square(trial.error.rotation_rad);
    result.translation_m += square(trial.error.translation_m);
    result.bound_rotation_rad += square(trial.bound.rotation_rad);
    result.bound_translation_m += square(trial.bound.translation_m);
  }
  for (double* sum : {&result.rotation_rad, &result.translation_m, &result.bound_rotation_rad,
                      &result.bound_translation_m}) {
    *sum = std::sqrt(*sum / counted);
  }
  return result;
}

}  // namespace

std::vector<AccuracyResult> StudyAccuracy(const AccuracyStudy& study,
                                          const AccuracyCondition& condition,
                                          std::span<const SolverPtr> solvers) {
  const auto count = static_cast<std::size_t>(study.trials);
  const int inliers = InlierCount(condition.scene.pairs, condition.outlier_fraction);
  std::vector<std::vector<Trial>> trials(solvers.size(), std::vector<Trial>(count));
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      Random random(DeriveSeed(study.seed, condition.name, 0, i));
      const RandomScene scene = MakeRandomScene(condition.scene, random);
      RandomScene mismatched = scene;
      MismatchPairs(condition.scene, inliers, random, mismatched);
      for (std::size_t k = 0; k < solvers.size(); ++k) {
        trials[k][i] = RunTrial(scene, mismatched.problem, inliers, *solvers[k]);
      }
      study.after_trial();
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < study.threads; ++i) workers.emplace_back(work);
  }
  std::vector<AccuracyResult> results;
  for (std::size_t k = 0; k < solvers.size(); ++k) {
    results.push_back(Summarise(solvers[k]->spec().name, condition.name, trials[k]));
  }
  return results;
}

}  // namespace sextant
