// SPDX-License-Identifier: Apache-2.0
#include "solvers/averaging/average.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "solvers/averaging/rotation_average.h"
#include "solvers/core/inner_solver.h"
#include "solvers/core/registry.h"
#include "solvers/core/subset.h"
#include "solvers/kernels/pair_terms.h"

namespace sextant {
namespace {

// With fewer views the 6x6 scatter matrix is singular.
constexpr std::size_t kMinViewsForCorrelations = 7;
constexpr std::size_t kMinViewsForScatter = 3;

// Sum of the squared weights (which sum to one) of the views' rotations in the average: 1/n for a
// mean, and 4^-(n-1) + sum_(k=1)^(n-1) 4^-k for the original's halving.
double SumOfSquaredWeights(RotationAverage kind, std::size_t views) {
  const double n = static_cast<double>(views);
  if (kind != RotationAverage::kOriginalRunning) return 1.0 / n;
  const double oldest = std::pow(4.0, 1.0 - n);
  return oldest + (1.0 - oldest) / 3.0;
}

// Covariance of the average of poses with the given covariance each.
Matrix6d ScaleToAverage(const Matrix6d& of_one, RotationAverage kind, std::size_t views) {
  Matrix6d scaled = of_one / static_cast<double>(views);
  scaled.topLeftCorner<3, 3>() = of_one.topLeftCorner<3, 3>() * SumOfSquaredWeights(kind, views);
  return scaled;
}

Matrix6d Scatter(std::span<const Rigid3d> poses, const Rigid3d& average) {
  const double n = static_cast<double>(poses.size());
  Vector6d sum = Vector6d::Zero();
  Matrix6d squares = Matrix6d::Zero();
  for (const Rigid3d& pose : poses) {
    const Vector6d d = PoseDifference(pose, average);
    sum += d;
    squares += d * d.transpose();
  }
  Matrix6d scatter = (squares - sum * sum.transpose() / n) / (n - 1.0);
  if (poses.size() >= kMinViewsForCorrelations) return scatter;
  return scatter.diagonal().cwiseMax(0.0).asDiagonal();
}

Expected<Eigen::Quaterniond> AverageRotation(std::span<const Rigid3d> poses, RotationAverage kind) {
  std::vector<Eigen::Quaterniond> rotations;
  for (const Rigid3d& pose : poses) rotations.push_back(pose.rotation);
  switch (kind) {
    case RotationAverage::kChordal:
      return ChordalMean(rotations);
    case RotationAverage::kQuaternionSum:
      return QuaternionSumMean(rotations);
    case RotationAverage::kOriginalRunning:
      return OriginalRunningAverage(rotations);
  }
  return ChordalMean(rotations);
}

}  // namespace

Expected<Rigid3d> AveragePoses(std::span<const Rigid3d> poses, RotationAverage kind) {
  SEXTANT_ASSIGN_OR_RETURN(const Eigen::Quaterniond rotation, AverageRotation(poses, kind));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Rigid3d& pose : poses) sum += pose.translation;
  return Rigid3d{rotation, sum / static_cast<double>(poses.size())};
}

std::vector<Rigid3d> AgreeingPoses(std::span<const PoseCandidates> views) {
  std::vector<Rigid3d> best;
  for (const PoseCandidates& candidates : views) best.push_back(candidates.front());
  const bool one_each = std::all_of(views.begin(), views.end(),
                                    [](const PoseCandidates& c) { return c.size() == 1; });
  if (one_each) return best;
  double least = std::numeric_limits<double>::infinity();
  for (const PoseCandidates& candidates : views) {
    for (const Rigid3d& reference : candidates) {
      std::vector<Rigid3d> nearest;
      double sum = 0.0;
      for (const PoseCandidates& of_view : views) {
        const auto angle = [&](const Rigid3d& pose) {
          return RotationDistance(pose.rotation, reference.rotation);
        };
        nearest.push_back(*std::min_element(
            of_view.begin(), of_view.end(),
            [&](const Rigid3d& a, const Rigid3d& b) { return angle(a) < angle(b); }));
        sum += angle(nearest.back());
      }
      if (!(sum < least)) continue;
      least = sum;
      best = std::move(nearest);
    }
  }
  return best;
}

std::optional<Matrix6d> AverageCovariance(std::span<const Rigid3d> poses,
                                          std::span<const std::optional<Matrix6d>> covariances,
                                          const Rigid3d& average, RotationAverage kind) {
  if (poses.size() >= kMinViewsForScatter) {
    return ScaleToAverage(Scatter(poses, average), kind, poses.size());
  }
  Matrix6d mean = Matrix6d::Zero();
  for (const std::optional<Matrix6d>& covariance : covariances) {
    if (!covariance) return std::nullopt;
    mean += *covariance / static_cast<double>(covariances.size());
  }
  return ScaleToAverage(mean, kind, poses.size());
}

namespace {

struct AverageOptions {
  RotationAverage rotation = RotationAverage::kChordal;
};

const OptionSet<AverageOptions>& AverageOptionSet() {
  static const OptionSet<AverageOptions> options = OptionSet<AverageOptions>().Choice(
      "rotation", &AverageOptions::rotation, {"chordal", "quaternion_sum", "original_running"},
      "least-squares mean, the paper's formula, or what its package actually computes");
  return options;
}

class AverageSolver final : public Solver {
 public:
  AverageSolver(const std::string& name, SolverPtr inner, const AverageOptions& options)
      : Solver({.name = name,
                .needs = inner->spec().needs,
                .estimates_rotation = inner->spec().estimates_rotation,
                .is_global = inner->spec().is_global}),
        inner_(std::move(inner)),
        options_(options) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    Estimate estimate;
    std::vector<PoseCandidates> candidates;
    std::vector<std::optional<Matrix6d>> covariances;
    std::optional<Error> first_error;
    std::string failures;
    for (const auto& [view, indices] : IndicesByView(problem)) {
      const Expected<SolveReport> report = inner_->Solve(SubsetOf(problem, spec().needs, indices));
      if (!report) {
        if (!first_error) first_error = report.error();
        failures += fmt::format("; view {}: {}", view, report.error().message);
        continue;
      }
      candidates.push_back({report->cam_from_lidar});
      candidates.back().insert(candidates.back().end(), report->alternatives.begin(),
                               report->alternatives.end());
      covariances.push_back(report->covariance);
      Append(*report, view, indices, estimate);
    }
    if (candidates.empty()) {
      return MakeError(first_error->code,
                       fmt::format("{}: no view could be solved{}", spec().name, failures));
    }
    const std::vector<Rigid3d> poses = AgreeingPoses(candidates);
    SEXTANT_ASSIGN_OR_RETURN(const Rigid3d average, AveragePoses(poses, options_.rotation));
    if (candidates.size() == 1) {
      estimate.alternatives.assign(candidates[0].begin() + 1, candidates[0].end());
    }
    estimate.cam_from_lidar = average;
    std::sort(estimate.inliers.begin(), estimate.inliers.end());
    // The scatter of the views, and the covariances of their answers, include what the noise of the
    // pairs adds, so it is estimated before there is a covariance to complete.
    CompleteNoise(problem, spec(), estimate);
    estimate.covariance = AverageCovariance(poses, covariances, average, options_.rotation);
    // What the answers of the views leave out is in their scatter.
    if (poses.size() >= kMinViewsForScatter) estimate.warnings.clear();
    return estimate;
  }

  std::map<int, std::vector<int>> IndicesByView(const CalibrationProblem& problem) const {
    std::map<int, std::vector<int>> views;
    const auto add = [&views](const auto& pairs) {
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        views[pairs[i].id.view].push_back(static_cast<int>(i));
      }
    };
    if (spec().needs.pairs_3d3d > 0) {
      add(problem.pairs_3d3d);
    } else {
      add(problem.pairs_2d3d);
    }
    return views;
  }

  // Adds the inliers, the warnings and the stage of one view.
  static void Append(const SolveReport& report, int view, std::span<const int> indices,
                     Estimate& estimate) {
    for (const int i : report.inliers) {
      estimate.inliers.push_back(indices[static_cast<std::size_t>(i)]);
    }
    for (const std::string& warning : report.warnings) {
      estimate.warnings.push_back(fmt::format("view {}: {}", view, warning));
    }
    estimate.iterations += report.iterations;
    estimate.termination = std::max(estimate.termination, report.termination);
    estimate.stages.push_back({.solver = fmt::format("{} on view {}", report.solver, view),
                               .cam_from_lidar = report.cam_from_lidar,
                               .iterations = report.iterations,
                               .wall_time_us = report.wall_time_us});
  }

  SolverPtr inner_;
  AverageOptions options_;
};

}  // namespace

SolverEntry AverageEntry() {
  return {
      .name = "average",
      .summary = "solves each view alone and averages the poses; the error is their scatter",
      .needs = "what the inner solver needs, in each view (views that fail are left out)",
      .reference = "section on averaging in the paper; Markley et al. 2007 (rotations)",
      .example = "average(kabsch)",
      .wraps_solver = true,
      .options = AverageOptionSet().Describe(),
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        const DataNeeds& needs = arguments.inner->spec().needs;
        if (needs.pairs_3d3d == 0 && needs.pairs_2d3d == 0) {
          return MakeError(
              ErrorCode::kInvalidOption,
              fmt::format("{}: {} works on data without view numbers; average a solver "
                          "of pairs",
                          arguments.name, arguments.inner->spec().name));
        }
        SEXTANT_RETURN_IF_ERROR(CheckKeepsCamera(*arguments.inner, arguments.name));
        return AverageOptionSet()
            .Parse(arguments.options)
            .map([&](const AverageOptions& o) -> SolverPtr {
              return std::make_shared<AverageSolver>(arguments.name, arguments.inner, o);
            });
      },
  };
}

}  // namespace sextant
