// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/solver.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "solvers/core/alternatives.h"
#include "solvers/core/board_view_check.h"
#include "solvers/core/local_frame.h"
#include "solvers/core/plausible.h"
#include "solvers/core/rivals.h"
#include "solvers/core/stated_noise.h"
#include "solvers/core/subset.h"
#include "solvers/core/unseen_pairs.h"

namespace sextant {
namespace {

Expected<void> CheckCount(std::size_t have, int need, const char* what, const std::string& solver) {
  if (need == 0 || have >= static_cast<std::size_t>(need)) return {};
  if (have == 0) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("{} needs {}, and the problem has none", solver, what));
  }
  return MakeError(ErrorCode::kTooFewPairs,
                   fmt::format("{} needs at least {} {}, got {}", solver, need, what, have));
}

bool IsSymmetricPositive(const Eigen::Matrix3d& m) {
  return m.isApprox(m.transpose(), 1e-9) && Eigen::LLT<Eigen::Matrix3d>(m).info() == Eigen::Success;
}

// Whether all pairs are finite and either all or none state a sigma, which is nearly always so.
// Takes no branch per number: 0 x is 0 for every finite x. False only means that CheckPairs must
// look.
bool AreOrdinary(std::span<const Pair3d3d> pairs) {
  double zero = 0.0;
  bool consistent = true;
  for (const Pair3d3d& pair : pairs) {
    const Eigen::Vector3d sum = pair.point_in_cam + pair.point_in_lidar;
    zero += 0.0 * (sum.x() + sum.y() + (sum.z() + pair.sigma_m));
    consistent = consistent && !pair.covariance_in_cam && pair.sigma_m >= 0.0 &&
                 (pair.sigma_m > 0.0) == (pairs[0].sigma_m > 0.0);
  }
  return consistent && zero == 0.0;
}

Expected<void> CheckPairs(std::span<const Pair3d3d> pairs) {
  if (AreOrdinary(pairs)) return {};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Pair3d3d& pair = pairs[i];
    const auto where = [&] { return fmt::format("3D-3D pair {} of {}", i + 1, pairs.size()); };
    if (!pair.point_in_cam.allFinite() || !pair.point_in_lidar.allFinite() ||
        !std::isfinite(pair.sigma_m)) {
      return MakeError(ErrorCode::kNonFinite, where() + " has a NaN or infinite number");
    }
    if (pair.sigma_m < 0.0) {
      return MakeError(
          ErrorCode::kInvalidInput,
          fmt::format("{} has sigma {} m, expected > 0, or 0 for unknown", where(), pair.sigma_m));
    }
    if (pair.covariance_in_cam && !IsSymmetricPositive(*pair.covariance_in_cam)) {
      return MakeError(ErrorCode::kInvalidInput,
                       where() + " has a covariance that is not symmetric positive definite");
    }
    if (HasKnownNoise(pair) != HasKnownNoise(pairs[0])) {
      return MakeError(ErrorCode::kInvalidInput,
                       where() +
                           " differs from the first in whether it states its noise; state it "
                           "for every pair or for none");
    }
  }
  return {};
}

bool AreOrdinary(std::span<const Pair2d3d> pairs) {
  double zero = 0.0;
  bool consistent = true;
  for (const Pair2d3d& pair : pairs) {
    const Eigen::Vector3d& point = pair.point_in_lidar;
    zero += 0.0 * ((pair.pixel.x() + pair.pixel.y()) + (point.x() + point.y()) +
                   (point.z() + pair.sigma_px));
    consistent &= pair.sigma_px >= 0.0;
    consistent &= (pair.sigma_px > 0.0) == (pairs[0].sigma_px > 0.0);
  }
  return consistent && zero == 0.0;
}

Expected<void> CheckPairs(std::span<const Pair2d3d> pairs) {
  if (AreOrdinary(pairs)) return {};
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Pair2d3d& pair = pairs[i];
    const auto where = [&] { return fmt::format("2D-3D pair {} of {}", i + 1, pairs.size()); };
    if (!pair.pixel.allFinite() || !pair.point_in_lidar.allFinite() ||
        !std::isfinite(pair.sigma_px)) {
      return MakeError(ErrorCode::kNonFinite, where() + " has a NaN or infinite number");
    }
    if (pair.sigma_px < 0.0) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("{} has sigma {} px, expected > 0, or 0 for unknown", where(),
                                   pair.sigma_px));
    }
    if (HasKnownNoise(pair) != HasKnownNoise(pairs[0])) {
      return MakeError(ErrorCode::kInvalidInput,
                       where() +
                           " differs from the first in whether it states its noise; state it "
                           "for every pair or for none");
    }
  }
  return {};
}

Expected<void> CheckPoints(std::span<const Eigen::Vector3d> points, const char* frame) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) {
      return MakeError(ErrorCode::kNonFinite,
                       fmt::format("point {} of {} of the {} set has a NaN or infinite number",
                                   i + 1, points.size(), frame));
    }
  }
  return {};
}

// The pose with its camera, over all data.
void EvaluateReport(const CalibrationProblem& problem, SolveReport& report) {
  if (!report.camera) {
    report.evaluation = Evaluate(problem, report.cam_from_lidar);
    return;
  }
  CalibrationProblem with_camera = problem;
  with_camera.camera = report.camera->camera;
  report.evaluation = Evaluate(with_camera, report.cam_from_lidar);
}

// For a solver of pixels alone, to which the inliers then belong.
bool AllUsedProject(const SolveReport& report) {
  return std::all_of(report.inliers.begin(), report.inliers.end(), [&](int i) {
    return std::isfinite(report.evaluation.per_pair_px[static_cast<std::size_t>(i)]);
  });
}

bool HasUnseenPair(const SolveReport& report) {
  const std::vector<double>& residuals = report.evaluation.per_pair_px;
  // The sum, in vector instructions, mostly shows it.
  const auto count = static_cast<Eigen::Index>(residuals.size());
  if (std::isfinite(Eigen::Map<const Eigen::VectorXd>(residuals.data(), count).sum())) return false;
  return std::any_of(residuals.begin(), residuals.end(),
                     [](double r) { return !std::isfinite(r); });
}

}  // namespace

std::string_view ToString(Termination termination) {
  switch (termination) {
    case Termination::kClosedForm:
      return "closed_form";
    case Termination::kConverged:
      return "converged";
    case Termination::kMaxIterations:
      return "max_iterations";
  }
  return "unknown";
}

Expected<void> CheckProblem(const CalibrationProblem& problem, const SolverSpec& spec) {
  const DataNeeds& needs = spec.needs;
  const PointSets& sets = problem.point_sets;
  const std::size_t smaller_set = std::min(sets.in_cam.size(), sets.in_lidar.size());
  Expected<void> ok;
  const auto check = [&ok](auto&& next) {
    if (ok) ok = next();
  };
  check([&] {
    return CheckCount(problem.pairs_3d3d.size(), needs.pairs_3d3d, "3D-3D pairs", spec.name);
  });
  check([&] {
    return CheckCount(problem.pairs_2d3d.size(), needs.pairs_2d3d, "2D-3D pairs", spec.name);
  });
  check([&] {
    return CheckCount(smaller_set, needs.points_per_set, "points in each frame", spec.name);
  });
  check([&] {
    return CheckCount(problem.board_views.size(), needs.board_views, "raw views of boards",
                      spec.name);
  });
  check([&]() -> Expected<void> {
    if (needs.pairs_2d3d == 0 && needs.board_views == 0) return {};
    if (!problem.camera) {
      return MakeError(ErrorCode::kMissingData,
                       spec.name +
                           " needs the camera's intrinsics, and the problem has none; give them "
                           "in the problem or with --camera");
    }
    return ValidateCamera(*problem.camera);
  });
  check([&]() -> Expected<void> {
    if (!problem.initial_cam_from_lidar) {
      if (!needs.initial_pose) return {};
      return MakeError(ErrorCode::kMissingData, spec.name + " needs an initial cam_from_lidar");
    }
    if (!problem.initial_cam_from_lidar->IsFinite()) {
      return MakeError(ErrorCode::kNonFinite, "the initial cam_from_lidar is not finite");
    }
    return {};
  });
  if (needs.pairs_3d3d > 0) check([&] { return CheckPairs(problem.pairs_3d3d); });
  if (needs.pairs_2d3d > 0) check([&] { return CheckPairs(problem.pairs_2d3d); });
  if (needs.points_per_set > 0) {
    check([&] { return CheckPoints(sets.in_cam, "camera"); });
    check([&] { return CheckPoints(sets.in_lidar, "LiDAR"); });
  }
  if (needs.board_views > 0) {
    check([&] { return CheckBoardViews(problem.board_views, problem.boards); });
  }
  return ok;
}

Expected<Estimate> Solver::SolveWithAlternatives(const CalibrationProblem& problem) const {
  Expected<Estimate> estimate = DoSolve(problem);
  if (!estimate) return estimate;
  CompleteNoise(problem, spec_, *estimate);
  if (!estimate->cam_from_lidar.IsFinite() ||
      (estimate->covariance && !estimate->covariance->allFinite())) {
    return MakeError(ErrorCode::kNonFinite,
                     spec_.name + ": the arithmetic overflowed; are the coordinates in metres?");
  }
  LikelyPoses likely = FindLikelyPoses(problem, spec_, *estimate);
  std::size_t answer = likely.of_answer.value_or(likely.poses.size());
  if (answer > 0 && !likely.poses.empty()) {
    if (auto lowest = DoSolveFrom(problem, *estimate, likely.poses.front())) {
      *estimate = *std::move(lowest);
      CompleteNoise(problem, spec_, *estimate);
      answer = 0;
    }
  }
  if (answer < likely.poses.size()) {
    likely.poses.erase(likely.poses.begin() + static_cast<std::ptrdiff_t>(answer));
  }
  estimate->alternatives = std::move(likely.poses);
  return estimate;
}

Expected<SolveReport> Solver::SolveAndEvaluate(const CalibrationProblem& problem) const {
  const auto start = std::chrono::steady_clock::now();
  Expected<Estimate> estimate = SolveWithAlternatives(problem);
  const auto end = std::chrono::steady_clock::now();
  Expected<SolveReport> report(tl::in_place);
  if (!estimate) {
    report = tl::unexpected<Error>(std::move(estimate.error()));
    return report;
  }
  static_cast<Estimate&>(*report) = std::move(*estimate);
  report->solver = spec_.name;
  report->wall_time_us = std::chrono::duration<double, std::micro>(end - start).count();
  EvaluateReport(problem, *report);
  if (Expected<void> plausible = CheckPlausible(problem, spec_, *report); !plausible) {
    report = tl::unexpected<Error>(std::move(plausible.error()));
    return report;
  }
  for (Rigid3d& rival : FindRivals(problem, spec_, *report)) {
    report->alternatives.push_back(std::move(rival));
  }
  return report;
}

// Where the answer is based on a pixel that the camera model cannot explain, or where there is none
// and such pixels may be the reason, the others decide.
Expected<SolveReport> Solver::SolveSeenPairs(const CalibrationProblem& problem) const {
  Expected<SolveReport> report = SolveAndEvaluate(problem);
  const bool of_pixels = spec_.needs.pairs_2d3d > 0 && spec_.needs.pairs_3d3d == 0;
  if (!of_pixels || problem.camera->model == CameraModel::kPinhole) return report;
  if (report && AllUsedProject(*report)) return report;
  const std::vector<int> seen = PairsWithRay(problem);
  const bool are_enough = seen.size() >= static_cast<std::size_t>(spec_.needs.pairs_2d3d);
  if (seen.size() == problem.pairs_2d3d.size() || !are_enough) return report;
  report = SolveAndEvaluate(SubsetOf(problem, spec_.needs, seen));
  if (!report) return report;
  for (int& i : report->inliers) i = seen[static_cast<std::size_t>(i)];
  EvaluateReport(problem, *report);
  return report;
}

Expected<SolveReport> Solver::Solve(const CalibrationProblem& problem) const {
  SEXTANT_RETURN_IF_ERROR(CheckProblem(problem, spec_));
  const std::optional<LocalFrame> frame = LocalFrame::For(problem, spec_.needs);
  const std::optional<CalibrationProblem> moved =
      frame ? std::optional(frame->Localised(problem)) : std::nullopt;
  const CalibrationProblem& local = moved ? *moved : problem;
  Expected<SolveReport> report = SolveSeenPairs(local);
  if (!report) return report;
  WidenUnderstatedNoise(local, spec_, *report);
  if (HasUnseenPair(*report)) {
    const Camera& camera = report->camera ? report->camera->camera : *problem.camera;
    for (std::string& note : NotesOnUnseenPairs(local, camera, report->cam_from_lidar)) {
      report->warnings.push_back(std::move(note));
    }
  }
  if (frame) frame->Restore(*report);
  return report;
}

void Solver::DoHypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                           std::vector<Rigid3d>& poses) const {
  const Expected<Estimate> estimate = DoSolve(SubsetOf(problem, spec_.needs, sample));
  if (!estimate) return;
  poses.push_back(estimate->cam_from_lidar);
  poses.insert(poses.end(), estimate->alternatives.begin(), estimate->alternatives.end());
}

}  // namespace sextant
