// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "geometry/symmetric.h"
#include "solvers/core/board_view_check.h"
#include "solvers/core/inner_solver.h"
#include "solvers/core/registry.h"
#include "solvers/joint/joint_observability.h"
#include "solvers/joint/joint_search.h"
#include "solvers/kernels/pair_terms.h"
#include "solvers/refine/refine_camera.h"

namespace sextant {
namespace {

DataNeeds WithViews(DataNeeds needs) {
  needs.board_views = 1;
  return needs;
}

// Robust cost of one view with its board at `cam_from_board`; infinite where a residual is
// undefined.
double CostAt(const JointView& view, const JointUnknowns& unknowns, const JointState& state,
              const Rigid3d& cam_from_board) {
  JointState alone = state;
  alone.cam_from_board = {cam_from_board};
  const RobustLoss loss{.kind = LossKind::kCauchy, .scale = 3.0};
  const auto system = Linearise({view}, unknowns, {loss, loss, loss}, alone);
  return system ? system->cost : std::numeric_limits<double>::infinity();
}

/// argmin of 1/2 sum |r|^2 over cam_from_lidar and the pose of every board, r the whitened
/// residuals of the raw observations (solvers/joint/board_view_residuals.h), from the inner
/// solver's pose.
///
/// See SearchJointly for outliers and MinimiseJointly for the method. Covariance: inverse of the
/// information with the boards' poses, and all else that was estimated, eliminated. Inliers: the
/// pairs of the boards and views in use. Termination kConverged: every step is under
/// step_tolerance. An unobservable parameter is fixed at its given value, with a warning. Errors:
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
    SEXTANT_ASSIGN_OR_RETURN(JointUnknowns unknowns, UnknownsOf(problem));
    std::vector<JointView> views = ViewsOf(problem, unknowns);
    JointState state = StateAt(problem, start.cam_from_lidar, unknowns, views);
    Estimate estimate;
    FixUnobservable(problem, InformationAt(views, unknowns, state), unknowns, views, state,
                    estimate.warnings);
    while (true) {
      SEXTANT_ASSIGN_OR_RETURN(JointAnswer answer, SearchJointly(views, unknowns, state, options_));
      estimate.iterations += answer.iterations;
      const Eigen::MatrixXd information = SharedInformation(answer.minimum.system);
      if (FixUnobservable(problem, information, unknowns, views, state, estimate.warnings)) {
        continue;
      }
      SEXTANT_RETURN_IF_ERROR(Report(problem, unknowns, answer, information, estimate));
      break;
    }
    estimate.stages = std::move(start.stages);
    estimate.stages.push_back(
        {start.solver, start.cam_from_lidar, start.iterations, start.wall_time_us});
    return estimate;
  }

  Expected<JointUnknowns> UnknownsOf(const CalibrationProblem& problem) const {
    JointUnknowns unknowns;
    unknowns.range_bias = options_.range_bias;
    unknowns.board_size = options_.board_size;
    if (options_.board_size == JointBoardSize::kSides) {
      std::set<int> ids;
      for (const BoardView& view : problem.board_views) ids.insert(view.board);
      unknowns.sized_boards.assign(ids.begin(), ids.end());
    }
    return FreeIntrinsics(*problem.camera, options_.intrinsics)
        .map([&](const std::vector<int>& free) {
          unknowns.intrinsics = free;
          return unknowns;
        });
  }

  static std::vector<JointView> ViewsOf(const CalibrationProblem& problem,
                                        const JointUnknowns& unknowns) {
    std::vector<JointView> views;
    const std::vector<int>& sized = unknowns.sized_boards;
    for (const BoardView& view : problem.board_views) {
      const auto at = std::find(sized.begin(), sized.end(), view.board);
      views.push_back({TermsOf(view, *FindBoard(problem.boards, view.board)),
                       at == sized.end() ? -1 : static_cast<int>(at - sized.begin())});
    }
    return views;
  }

  // Starts each board at the one of the two sensors' poses that fits the observations of both
  // better.
  static JointState StateAt(const CalibrationProblem& problem, const Rigid3d& cam_from_lidar,
                            const JointUnknowns& unknowns, const std::vector<JointView>& views) {
    JointState state;
    state.cam_from_lidar = cam_from_lidar;
    state.size.setZero(unknowns.SizeCount());
    state.camera = *problem.camera;
    std::vector<Rigid3d> chosen;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const Rigid3d by_camera = problem.board_views[i].cam_from_board;
      const Rigid3d by_lidar = cam_from_lidar * problem.board_views[i].lidar_from_board;
      const bool camera_is_better = CostAt(views[i], unknowns, state, by_camera) <=
                                    CostAt(views[i], unknowns, state, by_lidar);
      chosen.push_back(camera_is_better ? by_camera : by_lidar);
    }
    state.cam_from_board = std::move(chosen);
    return state;
  }

  // Used before the search, in which an unobservable parameter would drift.
  static Eigen::MatrixXd InformationAt(const std::vector<JointView>& views,
                                       const JointUnknowns& unknowns, const JointState& state) {
    const JointSelection seen = SelectSeen(JointResidualsAt(views, unknowns, state));
    const auto system = Linearise(Selected(views, seen), unknowns, {}, state);
    return system ? SharedInformation(*system)
                  : Eigen::MatrixXd::Zero(unknowns.Count(), unknowns.Count());
  }

  // True where there was one. `state` is the start of the search, which is then repeated.
  static bool FixUnobservable(const CalibrationProblem& problem, Eigen::MatrixXd information,
                              JointUnknowns& unknowns, std::vector<JointView>& views,
                              JointState& state, std::vector<std::string>& warnings) {
    bool any = false;
    while (const auto unobservable = FindUnobservable(
               information, UsefulSigmas(views, unknowns, state, problem.boards))) {
      warnings.push_back(DescribeUnobservable(*unobservable, unknowns, *problem.camera));
      FixParameter(unobservable->index, problem, unknowns, views, state);
      information = InformationAt(views, unknowns, state);
      any = true;
    }
    return any;
  }

  Expected<void> Report(const CalibrationProblem& problem, const JointUnknowns& unknowns,
                        const JointAnswer& answer, const Eigen::MatrixXd& information,
                        Estimate& estimate) const {
    const auto covariance = InvertSymmetric(information);
    if (!covariance) {
      return MakeError(ErrorCode::kDegenerate,
                       "the views leave a direction of the pose undetermined; hold the board at "
                       "more positions and tilts");
    }
    const JointState& state = answer.minimum.state;
    estimate.cam_from_lidar = state.cam_from_lidar;
    estimate.termination = Termination::kConverged;
    estimate.covariance = covariance->topLeftCorner<6, 6>();
    ReportParameters(unknowns, state, *covariance, problem.boards, estimate);
    if (estimate.camera && !ValidateCamera(estimate.camera->camera)) {
      return MakeError(ErrorCode::kNoConvergence,
                       "the distortion found folds the image; free fewer intrinsics");
    }
    estimate.board_views = FitsOf(problem, unknowns, answer);
    estimate.inliers = InliersOf(problem, estimate.board_views);
    WarnOfViews(estimate);
    WarnOfNoise(answer.noise, estimate);
    return {};
  }

  static void ReportParameters(const JointUnknowns& unknowns, const JointState& state,
                               const Eigen::MatrixXd& covariance, std::span<const Board> boards,
                               Estimate& estimate) {
    if (!unknowns.intrinsics.empty()) estimate.camera = CameraEstimate{state.camera, {}};
    const IntrinsicVector numbers = IntrinsicsOf(state.camera);
    for (int i = 6; i < unknowns.Count(); ++i) {
      EstimatedNumber number{NameOf(unknowns, state.camera, i), 0.0, std::sqrt(covariance(i, i))};
      if (i < unknowns.Size()) {
        number.value = state.range_bias_m;
      } else if (i < unknowns.Intrinsic()) {
        const int at = i - unknowns.Size();
        number.value = state.size[at] + GivenSize(unknowns, boards, at);
      } else {
        number.value =
            numbers[unknowns.intrinsics[static_cast<std::size_t>(i - unknowns.Intrinsic())]];
        estimate.camera->estimated.push_back(std::move(number));
        continue;
      }
      estimate.extras.push_back(std::move(number));
    }
  }

  static double GivenSize(const JointUnknowns& unknowns, std::span<const Board> boards, int at) {
    if (unknowns.board_size == JointBoardSize::kScale) return 1.0;
    const Board* board = FindBoard(boards, unknowns.sized_boards[static_cast<std::size_t>(at / 2)]);
    return at % 2 == 0 ? board->top_right_m : board->right_bottom_m;
  }

  static std::vector<BoardViewFit> FitsOf(const CalibrationProblem& problem,
                                          const JointUnknowns& unknowns,
                                          const JointAnswer& answer) {
    const JointState& state = answer.minimum.state;
    const std::vector<JointView> kept = Selected(ViewsOf(problem, unknowns), answer.selection);
    std::vector<BoardViewFit> fits;
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const BoardView& view = problem.board_views[i];
      const BoardViewTerms& terms = kept[i].terms;
      const auto count = [](std::size_t used, std::size_t of) {
        return ObservationCount{static_cast<int>(used), static_cast<int>(of)};
      };
      BoardViewFit fit{.view = view.view, .board = view.board};
      fit.cam_from_board = state.cam_from_board[i];
      fit.printed = count(terms.printed.size(), view.printed.size());
      fit.face = count(terms.face.size(), view.face_in_lidar.size());
      fit.edges = count(terms.edges.size(), view.edges.size());
      fit.used = !terms.printed.empty();
      fit.rms = fit.used ? RmsOf(kept[i], unknowns, state, state.cam_from_board[i]) : 0.0;
      fits.push_back(fit);
    }
    return fits;
  }

  static double RmsOf(const JointView& view, const JointUnknowns& unknowns, JointState state,
                      const Rigid3d& cam_from_board) {
    state.cam_from_board = {cam_from_board};
    double count = static_cast<double>(view.terms.face.size() + view.terms.edges.size());
    for (const PrintedTerm& term : view.terms.printed) {
      count += 2.0 * static_cast<double>(term.pixels.size());
    }
    return std::sqrt(2.0 * Linearise({view}, unknowns, {}, state)->cost / count);
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

  static void WarnOfViews(Estimate& estimate) {
    for (const BoardViewFit& fit : estimate.board_views) {
      if (fit.used) continue;
      const bool one_sided = fit.printed.of == 0 || fit.face.of + fit.edges.of == 0;
      estimate.warnings.push_back(fmt::format(
          "board {} of view {} was left out: {}", fit.board, fit.view,
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
          "{} is {:.1f} times as large as stated, so that the covariance is too small; "
          "state a larger noise, or look for a systematic error (intrinsics, board size)",
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
