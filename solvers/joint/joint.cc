// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "solvers/core/inner_solver.h"
#include "solvers/core/registry.h"
#include "solvers/joint/joint_model.h"
#include "solvers/joint/joint_search.h"
#include "solvers/joint/joint_start.h"

namespace sextant {
namespace {

DataNeeds WithViews(DataNeeds needs) {
  needs.board_views = 1;
  return needs;
}

/// argmin of 1/2 sum |r|^2 over cam_from_lidar and the pose of every board, r the whitened
/// residuals of the raw observations (solvers/joint/board_view_residuals.h), from the inner
/// solver's pose.
///
/// The LiDAR's systematic errors (CalibrationProblem::lidar_errors) are estimated along with the
/// poses, and so is the level of each kind of noise. See SearchJointly for outliers and
/// JointProblem for the method. Covariance: of the pose, marginal over all else that was estimated.
/// A number that the views do not determine stays at its prior. Inliers: the pairs of the boards
/// and views in use. Termination kConverged: Ceres's step is under step_tolerance. Errors:
/// kDegenerate, kNoConvergence, kInvalidInput (distortion of a pinhole), those of the inner solver.
class JointSolver final : public Solver {
 public:
  JointSolver(const SolverArguments& arguments, const JointOptions& options)
      : Solver({.name = arguments.name,
                .needs = WithViews(arguments.inner->spec().needs),
                .estimates_rotation = true,
                .is_global = FindsWholePose(arguments.inner->spec()),
                .estimates_camera = options.intrinsics != 0U}),
        inner_(arguments.inner),
        options_(options) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    SEXTANT_ASSIGN_OR_RETURN(SolveReport start, inner_->Solve(problem));
    SEXTANT_ASSIGN_OR_RETURN(const JointModel model, ModelOf(problem, options_));
    const JointState state = StartAt(problem, model, start.cam_from_lidar);
    SEXTANT_ASSIGN_OR_RETURN(
        const JointAnswer answer,
        SearchJointly(model, state, problem.lidar_errors.view_shift_sigma_m, options_));
    Estimate estimate;
    SEXTANT_RETURN_IF_ERROR(Report(problem, model, answer, estimate));
    estimate.stages = std::move(start.stages);
    estimate.stages.push_back(
        {start.solver, start.cam_from_lidar, start.iterations, start.wall_time_us});
    return estimate;
  }

  Expected<void> Report(const CalibrationProblem& problem, const JointModel& model,
                        const JointAnswer& answer, Estimate& estimate) const {
    const JointState& state = answer.state;
    estimate.cam_from_lidar = state.cam_from_lidar;
    estimate.termination = Termination::kConverged;
    estimate.iterations = answer.iterations;
    estimate.covariance = answer.covariance.topLeftCorner<6, 6>();
    ReportNumbers(model, answer, estimate);
    if (estimate.camera && !ValidateCamera(estimate.camera->camera)) {
      return MakeError(ErrorCode::kNoConvergence,
                       "the distortion found folds the image; free fewer intrinsics");
    }
    estimate.board_views = FitsOf(problem, model, answer);
    estimate.inliers = InliersOf(problem, estimate.board_views);
    WarnOfViews(problem, estimate);
    WarnOfNoise(answer.noise, estimate);
    return {};
  }

  static void ReportNumbers(const JointModel& model, const JointAnswer& answer,
                            Estimate& estimate) {
    if (!model.intrinsics.empty()) {
      estimate.camera = CameraEstimate{model.CameraWith(answer.state.shared.back()), {}};
    }
    Eigen::Index at = 6;
    for (std::size_t k = 0; k < model.shared.size(); ++k) {
      const SharedBlock& block = model.shared[k];
      const bool of_camera = estimate.camera && k + 1 == model.shared.size();
      for (std::size_t i = 0; i < block.names.size(); ++i, ++at) {
        if (!block.reported) continue;
        EstimatedNumber number{block.names[i], answer.state.shared[k][static_cast<Eigen::Index>(i)],
                               std::sqrt(answer.covariance(at, at))};
        (of_camera ? estimate.camera->estimated : estimate.extras).push_back(std::move(number));
      }
    }
  }

  static std::vector<BoardViewFit> FitsOf(const CalibrationProblem& problem,
                                          const JointModel& model, const JointAnswer& answer) {
    std::vector<BoardViewFit> fits;
    for (std::size_t i = 0; i < model.views.size(); ++i) {
      const BoardView& view = problem.board_views[i];
      const JointViewSelection& chosen = answer.selection[i];
      const auto count = [](const std::vector<bool>& of) {
        return ObservationCount{static_cast<int>(std::count(of.begin(), of.end(), true)),
                                static_cast<int>(of.size())};
      };
      fits.push_back({.view = view.view,
                      .board = view.board,
                      .used = chosen.IsUsed(),
                      .cam_from_board = answer.state.boards[i].cam_from_board,
                      .printed = count(chosen.printed),
                      .face = count(chosen.face),
                      .edges = count(chosen.edges),
                      .rms = chosen.IsUsed() ? RmsOf(model, answer, i) : 0.0});
    }
    return fits;
  }

  static double RmsOf(const JointModel& model, const JointAnswer& answer, std::size_t i) {
    const BoardViewResiduals residuals = ResidualsAt(model, answer.state, i);
    const JointViewSelection& chosen = answer.selection[i];
    double squares = 0.0;
    double count = 0.0;
    const auto add = [&](double residual, double size) {
      squares += size * residual * residual;
      count += size;
    };
    for (std::size_t k = 0; k < chosen.printed.size(); ++k) {
      const auto points = static_cast<double>(model.views[i].terms.printed[k].pixels.size());
      if (chosen.printed[k]) add(residuals.printed[k], 2.0 * points);
    }
    for (std::size_t k = 0; k < chosen.face.size(); ++k) {
      if (chosen.face[k]) add(residuals.face[k], 1.0);
    }
    for (std::size_t k = 0; k < chosen.edges.size(); ++k) {
      if (chosen.edges[k]) add(residuals.edges[k], 1.0);
    }
    return std::sqrt(squares / count);
  }

  // Indices into the kind of pairs that the inner solver uses.
  std::vector<int> InliersOf(const CalibrationProblem& problem,
                             const std::vector<BoardViewFit>& fits) const {
    std::set<std::pair<int, int>> used;
    for (const BoardViewFit& fit : fits) {
      if (fit.used) used.emplace(fit.view, fit.board);
    }
    std::vector<int> inliers;
    const auto add = [&](const auto& pairs) {
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (used.contains({pairs[i].id.view, pairs[i].id.board})) {
          inliers.push_back(static_cast<int>(i));
        }
      }
    };
    if (spec().needs.pairs_3d3d > 0) {
      add(problem.pairs_3d3d);
    } else if (spec().needs.pairs_2d3d > 0) {
      add(problem.pairs_2d3d);
    }
    return inliers;
  }

  static void WarnOfViews(const CalibrationProblem& problem, Estimate& estimate) {
    for (std::size_t i = 0; i < estimate.board_views.size(); ++i) {
      const BoardViewFit& fit = estimate.board_views[i];
      if (fit.used) continue;
      const std::string& name = problem.board_views[i].name;
      const bool one_sided = fit.printed.of == 0 || fit.face.of + fit.edges.of == 0;
      estimate.warnings.push_back(fmt::format(
          "board {} of view {} was left out: {}", fit.board,
          name.empty() ? std::to_string(fit.view) : name,
          one_sided ? "only one of the sensors saw it"
                    : "its image and its scan contradict the other views; was the board still, "
                      "and are its corners in the right order?"));
    }
  }

  // A ratio of 1.5 is more than an inaccurate estimate of a sigma.
  static void WarnOfNoise(const JointNoise& noise, Estimate& estimate) {
    constexpr double kMuch = 1.5;
    const auto warn = [&](double ratio, const char* what) {
      if (ratio <= kMuch) return;
      estimate.warnings.push_back(fmt::format(
          "{} is {:.1f} times as large as stated, which the covariance includes; look for a "
          "systematic error (intrinsics, board size)",
          what, ratio));
    };
    warn(noise.printed, "the noise of the printed corners");
    warn(noise.face, "the noise of the ranges on the boards");
    warn(noise.edges, "the noise of the boards' edges");
  }

  SolverPtr inner_;
  JointOptions options_;
};

Expected<SolverPtr> MakeJoint(const SolverArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(const JointOptions options, JointOptionSet().Parse(arguments.options));
  SEXTANT_RETURN_IF_ERROR(CheckKeepsCamera(*arguments.inner, arguments.name));
  return std::make_shared<JointSolver>(arguments, options);
}

}  // namespace

SolverEntry JointEntry() {
  return {
      .name = "joint",
      .summary =
          "least squares over the pose and every board's pose, on the raw observations of both "
          "sensors",
      .needs = "what the inner solver needs, and raw views of boards (images and scans)",
      .reference = "Triggs et al. 2000, bundle adjustment",
      .example = "joint(kabsch)",
      .wraps_solver = true,
      .options = JointOptionSet().Describe(),
      .make = MakeJoint,
  };
}

}  // namespace sextant
