// SPDX-License-Identifier: Apache-2.0
#include "eval/view_study.h"

#include <Eigen/Cholesky>
#include <atomic>
#include <cmath>
#include <optional>
#include <thread>

#include "base/random.h"
#include "eval/bounds.h"

namespace sextant {
namespace {

struct ViewTrial {
  std::optional<Error> error;  // Of the session itself.
  RmsError bound;
  struct Answer {
    bool answered = false;
    PoseDistance error;
    double nees = 0.0;
  };
  std::vector<Answer> answers;  // One a solver.
};

ViewTrial::Answer AnswerOf(const SimulatedViews& session, const Solver& solver) {
  const Expected<SolveReport> report = solver.Solve(session.problem);
  if (!report || !report->covariance) return {};
  const Vector6d error = PoseDifference(report->cam_from_lidar, session.true_cam_from_lidar);
  return {.answered = true,
          .error = DistanceBetween(report->cam_from_lidar, session.true_cam_from_lidar),
          .nees = error.dot(report->covariance->ldlt().solve(error)) / 6.0};
}

ViewTrial RunViewTrial(const ViewSimulation& simulation, std::span<const SolverPtr> solvers) {
  ViewTrial trial;
  const Expected<SimulatedViews> session = SimulateViews(simulation);
  if (!session) {
    trial.error = session.error();
    return trial;
  }
  const Expected<Matrix6d> bound = CramerRaoBoundOfViews(
      session->problem, session->true_cam_from_lidar, session->true_cam_from_board);
  if (!bound) {
    trial.error = bound.error();
    return trial;
  }
  trial.bound = RmsOf(*bound);
  for (const SolverPtr& solver : solvers) trial.answers.push_back(AnswerOf(*session, *solver));
  return trial;
}

double Square(double x) { return x * x; }

ViewResult Summarise(std::span<const ViewTrial> trials, std::size_t solver) {
  ViewResult result;
  int counted = 0;
  for (const ViewTrial& trial : trials) {
    ++result.trials;
    const ViewTrial::Answer& answer = trial.answers[solver];
    if (!answer.answered) {
      ++result.unanswered;
      continue;
    }
    ++counted;
    result.rotation_rad += Square(answer.error.rotation_rad);
    result.translation_m += Square(answer.error.translation_m);
    result.bound_rotation_rad += Square(trial.bound.rotation_rad);
    result.bound_translation_m += Square(trial.bound.translation_m);
    result.nees += answer.nees;
  }
  for (double* sum : {&result.rotation_rad, &result.translation_m, &result.bound_rotation_rad,
                      &result.bound_translation_m}) {
    *sum = std::sqrt(*sum / counted);
  }
  result.nees /= counted;
  return result;
}

}  // namespace

Expected<std::vector<ViewResult>> StudyViews(const ViewStudy& study, int views,
                                             std::span<const SolverPtr> solvers) {
  const auto count = static_cast<std::size_t>(study.trials);
  std::vector<ViewTrial> trials(count);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      ViewSimulation simulation = study.simulation;
      simulation.views = views;
      simulation.seed = DeriveSeed(study.seed, "views", static_cast<std::uint64_t>(views), i);
      trials[i] = RunViewTrial(simulation, solvers);
      study.after_trial();
    }
  };
  {
    std::vector<std::jthread> workers;
    for (int i = 0; i < study.threads; ++i) workers.emplace_back(work);
  }
  for (const ViewTrial& trial : trials) {
    if (trial.error) return tl::unexpected<Error>(*trial.error);
  }
  std::vector<ViewResult> results;
  for (std::size_t k = 0; k < solvers.size(); ++k) {
    results.push_back(Summarise(trials, k));
    results.back().solver = solvers[k]->spec().name;
    results.back().views = views;
  }
  return results;
}

}  // namespace sextant
