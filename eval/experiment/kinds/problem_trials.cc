// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/kinds/problem_trials.h"

#include <fmt/core.h>

#include <numbers>

#include "eval/metrics/bounds.h"
#include "solvers/external/imported_solver.h"

namespace sextant {
namespace {

// The kinds of data that a solver uses; solvers that use the same kinds share a problem and a
// bound.
struct DataKinds {
  bool points = false;
  bool pixels = false;
  bool sets = false;
  bool views = false;

  friend bool operator==(const DataKinds&, const DataKinds&) = default;
};

DataKinds KindsOf(const SolverSpec& spec) {
  return {.points = spec.needs.pairs_3d3d > 0,
          .pixels = spec.needs.pairs_2d3d > 0,
          .sets = spec.needs.points_per_set > 0,
          .views = spec.needs.board_views > 0};
}

CalibrationProblem ViewOf(const CalibrationProblem& problem, const DataKinds& kinds) {
  CalibrationProblem view;
  view.camera = problem.camera;
  view.boards = problem.boards;
  view.initial_cam_from_lidar = problem.initial_cam_from_lidar;
  if (kinds.points) view.pairs_3d3d = problem.pairs_3d3d;
  if (kinds.pixels) view.pairs_2d3d = problem.pairs_2d3d;
  if (kinds.sets) view.point_sets = problem.point_sets;
  if (kinds.views) view.board_views = problem.board_views;
  view.lidar_errors = problem.lidar_errors;
  return view;
}

// Sets the bound for the data that the solver may use; it stays NaN if there is none.
void MeasureBound(const KnownProblem& known, DataKinds kinds, MetricValues& values) {
  // At best, unpaired points are paired correctly.
  kinds.points = kinds.points || kinds.sets;
  const CalibrationProblem seen = ViewOf(known.inliers, kinds);
  const Expected<Matrix6d> bound =
      kinds.views ? CramerRaoBoundOfViews(seen, known.cam_from_lidar, known.cam_from_board)
                  : CramerRaoBound(seen, known.cam_from_lidar);
  if (!bound) return;
  const RmsError rms = RmsOf(*bound);
  values.Set(kBoundRotationDeg, rms.rotation_rad * 180.0 / std::numbers::pi);
  values.Set(kBoundTranslationMm, rms.translation_m * 1e3);
}

class ProblemTrials final : public Trials {
 public:
  ProblemTrials(ProblemMaker maker, std::vector<SolverPtr> solvers, std::string condition)
      : maker_(std::move(maker)), solvers_(std::move(solvers)), condition_(std::move(condition)) {
    for (const SolverPtr& solver : solvers_) names_.push_back(solver->spec().name);
  }

  const std::vector<std::string>& subjects() const override { return names_; }

  Expected<CalibrationProblem> ProblemOf(const TrialId& id) const override {
    return maker_.make(id).map([](KnownProblem&& known) { return std::move(known.problem); });
  }

  void Run(const TrialId& id, TrialRows& rows) const override {
    const Expected<KnownProblem> known = maker_.make(id);
    CalibrationProblem view;
    std::optional<DataKinds> kinds;
    for (std::size_t k = 0; k < solvers_.size(); ++k) {
      MetricValues values = rows.Add(static_cast<int>(k));
      if (!known) continue;
      const SolverSpec& spec = solvers_[k]->spec();
      if (kinds != KindsOf(spec)) {
        kinds = KindsOf(spec);
        view = ViewOf(known->problem, *kinds);
      }
      // Only solvers that need a start pose may be given the truth.
      view.initial_cam_from_lidar = known->problem.initial_cam_from_lidar;
      if (spec.needs.initial_pose && !view.initial_cam_from_lidar) {
        view.initial_cam_from_lidar = known->cam_from_lidar;
      }
      const Expected<SolveReport> report = SolveTrial(*solvers_[k], view, condition_, id.trial);
      MeasurePose(*known, report, maker_.limits, values);
      if (maker_.measure_more) maker_.measure_more(*known, report, values);
      if (values.Wants(kBoundRotationDeg) || values.Wants(kBoundTranslationMm)) {
        MeasureBound(*known, *kinds, values);
      }
    }
  }

 private:
  ProblemMaker maker_;
  std::vector<SolverPtr> solvers_;
  std::string condition_;
  std::vector<std::string> names_;
};

}  // namespace

Expected<TrialsPtr> MakeProblemTrials(ProblemMaker maker, std::vector<SolverPtr> solvers,
                                      const std::string& condition) {
  SEXTANT_ASSIGN_OR_RETURN(const KnownProblem sample, maker.make({.trial = 0, .seed = 1}));
  CalibrationProblem problem = sample.problem;
  if (!problem.initial_cam_from_lidar) problem.initial_cam_from_lidar = sample.cam_from_lidar;
  std::string reasons;
  std::erase_if(solvers, [&](const SolverPtr& solver) {
    Expected<void> met = CheckProblem(problem, solver->spec());
    // Whether the points lie on a plane is only known after a fit.
    if (met && solver->spec().needs.points_on_plane) {
      met = solver->Solve(problem).map([](const SolveReport&) {});
    }
    if (!met) reasons += fmt::format("; {}", met.error().message);
    return !met;
  });
  if (solvers.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     "none of the solvers can use this condition's data" + reasons);
  }
  return std::make_shared<ProblemTrials>(std::move(maker), std::move(solvers), condition);
}

}  // namespace sextant
