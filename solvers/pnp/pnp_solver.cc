// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/pnp_solver.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <numeric>
#include <string>

#include "solvers/core/unseen_pairs.h"
#include "solvers/kernels/pair_terms.h"
#include "solvers/least_squares/refine_pose.h"
#include "solvers/pnp/explained.h"
#include "solvers/pnp/moment_covariance.h"
#include "solvers/pnp/object_space_covariance.h"
#include "solvers/pnp/p3p_solver.h"
#include "solvers/pnp/plane_frame.h"
#include "solvers/pnp/pnp_view.h"
#include "solvers/pnp/reprojection_covariance.h"

namespace sextant {
namespace {

Rigid3d Turned(const Eigen::Quaterniond& turn, const Rigid3d& pose) {
  return Rigid3d{turn, Eigen::Vector3d::Zero()} * pose;
}

double FocalLengthPx(const Camera& camera) { return 0.5 * (camera.fx_px + camera.fy_px); }

/// The covariance through the moments; none for four different points, where the kernel also uses
/// the pixels themselves.
std::optional<Matrix6d> ThroughChain(const MomentsKernel& of_moments, const PnpView& view,
                                     std::span<const Eigen::Matrix2d> image_covariances,
                                     const Rigid3d& view_from_lidar) {
  constexpr std::size_t kMinDifferent = 5;
  const Expected<Correspondences> data =
      PrepareCorrespondences(view.image_points, view.points, kMinDifferent);
  if (!data) return std::nullopt;
  const PoseOfMoments estimate = of_moments(*data, view_from_lidar);
  if (!estimate) return std::nullopt;
  return ChainedMomentCovariance(*data, image_covariances, estimate);
}

/// The covariance through the kernel, with its solution `view_from_lidar`.
std::optional<Matrix6d> ThroughMoments(const PnpKernel& kernel, double focal_length_px,
                                       const PnpView& view,
                                       std::span<const Eigen::Matrix2d> image_covariances,
                                       const Rigid3d& view_from_lidar) {
  const auto estimate = [&](std::span<const Eigen::Vector2d> image) -> std::optional<Rigid3d> {
    const Expected<PnpPoses> found =
        kernel({image, view.points, focal_length_px, {.near = &view_from_lidar}});
    if (!found) return std::nullopt;
    // Takes the pose nearest to the solution.
    const auto distance = [&](const Rigid3d& pose) {
      return PoseDifference(pose, view_from_lidar).squaredNorm();
    };
    return *std::min_element(
        found->poses.begin(), found->poses.begin() + found->count,
        [&](const Rigid3d& a, const Rigid3d& b) { return distance(a) < distance(b); });
  };
  return MomentCovariance(view.image_points, image_covariances, view.points, estimate);
}

/// Covariance of each image point (x/z, y/z) of a view that is turned from the camera by
/// `cam_from_view`, to first order in the noise of its pixel: sigma^2 (dm/dpixel)(dm/dpixel)^T by
/// the camera's own model. `unstated_variance` [px^2] is that of pixels that state no sigma. None
/// where a pixel does not determine a direction (the model's domain ends there).
std::optional<std::vector<Eigen::Matrix2d>> ImageCovariances(
    const Camera& camera, std::span<const Pair2d3d> pairs,
    std::span<const Eigen::Vector2d> image_points, const Eigen::Quaterniond& cam_from_view,
    double unstated_variance) {
  const Eigen::Matrix3d turn = cam_from_view.toRotationMatrix();
  std::vector<Eigen::Matrix2d> covariances;
  covariances.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto projection = ProjectWithJacobian(camera, turn * image_points[i].homogeneous());
    if (!projection) return std::nullopt;
    const Eigen::Matrix2d pixel_by_image = projection->pixel_by_point * turn.leftCols<2>();
    const Eigen::Matrix2d image_by_pixel = pixel_by_image.inverse();
    if (!image_by_pixel.allFinite()) return std::nullopt;
    const double variance =
        HasKnownNoise(pairs[i]) ? pairs[i].sigma_px * pairs[i].sigma_px : unstated_variance;
    covariances.emplace_back(variance * image_by_pixel * image_by_pixel.transpose());
  }
  return covariances;
}

/// The covariance in the camera frame; the rotation of the kernel's view is not differentiated.
std::optional<Matrix6d> KernelCovariance(const PnpKernel& kernel, PnpCovariance kind,
                                         const MomentsKernel& of_moments, const Camera& camera,
                                         std::span<const Pair2d3d> pairs, const PnpView& view,
                                         const Rigid3d& cam_from_lidar) {
  const auto unstated = UnstatedVariance(camera, pairs, cam_from_lidar);
  if (!unstated) return std::nullopt;
  const auto image_covariances =
      ImageCovariances(camera, pairs, view.image_points, view.cam_from_view, *unstated);
  if (!image_covariances) return std::nullopt;
  const Rigid3d view_from_lidar = Turned(view.cam_from_view.conjugate(), cam_from_lidar);
  std::optional<Matrix6d> in_view;
  if (kind == PnpCovariance::kObjectSpace) {
    in_view =
        ObjectSpaceCovariance(view.image_points, *image_covariances, view.points, view_from_lidar);
  } else if (of_moments) {
    in_view = ThroughChain(of_moments, view, *image_covariances, view_from_lidar);
  }
  if (!in_view && kind == PnpCovariance::kMoments) {
    in_view =
        ThroughMoments(kernel, FocalLengthPx(camera), view, *image_covariances, view_from_lidar);
  }
  if (!in_view) return std::nullopt;
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() =
      view.cam_from_view.toRotationMatrix();
  return Matrix6d(turn * *in_view * turn.transpose());
}

// The answer to pixels that no image plane holds: least squares of the pixels by the camera's own
// model, from the poses of p3p, which needs rays only.
Expected<Estimate> SolveWideView(const CalibrationProblem& problem, const std::string& solver) {
  constexpr RefineLimits kLimits = {.max_iterations = 100, .step_tolerance = 1e-10};
  SEXTANT_ASSIGN_OR_RETURN(const SolveReport start, MakeP3p()->Solve(problem));
  std::vector<Rigid3d> starts = {start.cam_from_lidar};
  starts.insert(starts.end(), start.alternatives.begin(), start.alternatives.end());
  const PairTerms terms = MakeTerms(problem, PairKind::k2d3d);
  std::optional<RefinedPose> best;
  for (const Rigid3d& pose : starts) {
    const RefinedPose refined = RefinePose(terms.View(), pose, kLimits);
    if (!refined.cam_from_lidar.IsFinite() || refined.outcome == RefineOutcome::kNotProjected)
      continue;
    if (!best || refined.cost < best->cost) best = refined;
  }
  if (!best) {
    return MakeError(ErrorCode::kNoConsensus,
                     solver +
                         ": a pixel used has no residual at the poses of p3p; check the "
                         "camera and which pixel belongs to which point");
  }
  Estimate estimate;
  estimate.cam_from_lidar = best->cam_from_lidar;
  estimate.termination = best->outcome == RefineOutcome::kMaxIterations
                             ? Termination::kMaxIterations
                             : Termination::kConverged;
  estimate.iterations = best->iterations;
  estimate.inliers.resize(problem.pairs_2d3d.size());
  std::iota(estimate.inliers.begin(), estimate.inliers.end(), 0);
  estimate.covariance =
      ReprojectionCovariance(*problem.camera, problem.pairs_2d3d, estimate.cam_from_lidar);
  estimate.warnings.push_back(solver +
                              ": the pixels span more than 168 deg of view, which no image plane "
                              "holds; the answer is least squares of the pixels from p3p's poses");
  return estimate;
}

}  // namespace

PnpSolver::PnpSolver(SolverSpec spec, PnpKernel kernel, PnpCovariance covariance,
                     WideViews wide_views)
    : Solver(std::move(spec)),
      kernel_(std::move(kernel)),
      covariance_(covariance),
      wide_views_(wide_views) {}

PnpSolver::PnpSolver(SolverSpec spec, PnpKernel kernel, MomentsKernel of_moments)
    : Solver(std::move(spec)),
      kernel_(std::move(kernel)),
      covariance_(PnpCovariance::kMoments),
      wide_views_(WideViews::kLeastSquares),
      of_moments_(std::move(of_moments)) {}

Expected<Estimate> PnpSolver::DoSolve(const CalibrationProblem& problem) const {
  const Camera& camera = *problem.camera;
  const std::vector<Pair2d3d>& pairs = problem.pairs_2d3d;
  Expected<PnpView> view = MakeView(camera, pairs);
  if (!view) {
    const bool is_wide = PairsWithRay(problem).size() == pairs.size();
    if (is_wide && wide_views_ == WideViews::kLeastSquares) {
      return SolveWideView(problem, spec().name);
    }
    return tl::unexpected<Error>(Named(view.error()));
  }
  Expected<PnpPoses> found = kernel_({view->image_points, view->points, FocalLengthPx(camera)});
  if (!found) return tl::unexpected<Error>(Named(found.error()));
  if (found->inliers.empty()) {
    const Expected<void> explained = CheckExplained(*view, found->poses[0]);
    if (!explained) return tl::unexpected<Error>(Named(explained.error()));
  }
  for (Rigid3d& pose : found->poses) pose = Turned(view->cam_from_view, pose);
  Estimate estimate;
  estimate.cam_from_lidar = found->poses[0];
  estimate.alternatives.assign(found->poses.begin() + 1, found->poses.begin() + found->count);
  estimate.iterations = found->iterations;
  estimate.inliers = std::move(found->inliers);
  if (estimate.inliers.empty()) {
    estimate.inliers.resize(pairs.size());
    std::iota(estimate.inliers.begin(), estimate.inliers.end(), 0);
  }
  const Rigid3d& pose = estimate.cam_from_lidar;
  if (covariance_ == PnpCovariance::kTriple) {
    estimate.covariance = TripleCovariance(camera, pairs, found->fixed_by.value(), pose);
  } else if (covariance_ == PnpCovariance::kLeastSquares) {
    std::vector<Pair2d3d> used;
    for (const int i : estimate.inliers) used.push_back(pairs[static_cast<std::size_t>(i)]);
    estimate.covariance = ReprojectionCovariance(camera, used, pose);
  } else {
    if (spec().needs.points_on_plane) FlattenOntoPlane(view->points);
    estimate.covariance =
        KernelCovariance(kernel_, covariance_, of_moments_, camera, pairs, *view, pose);
  }
  return estimate;
}

Error PnpSolver::Named(Error error) const {
  error.message = spec().name + ": " + error.message;
  return error;
}

void PnpSolver::DoHypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                              std::vector<Rigid3d>& poses) const {
  constexpr std::size_t kMaxOnStack = 64;
  const Camera& camera = *problem.camera;
  const auto pair = [&](std::size_t i) -> const Pair2d3d& {
    return problem.pairs_2d3d[static_cast<std::size_t>(sample[i])];
  };
  const auto append = [&](std::span<const Eigen::Vector2d> image_points,
                          std::span<const Eigen::Vector3d> points,
                          const Eigen::Quaterniond& cam_from_view) {
    const Expected<PnpPoses> found =
        kernel_({image_points, points, FocalLengthPx(camera), {.unchecked = true}});
    for (int i = 0; found && i < found->count; ++i) {
      poses.push_back(Turned(cam_from_view, found->poses[static_cast<std::size_t>(i)]));
    }
  };
  if (sample.size() > kMaxOnStack) {
    std::vector<Pair2d3d> pairs;
    for (std::size_t i = 0; i < sample.size(); ++i) pairs.push_back(pair(i));
    const Expected<PnpView> view = MakeView(camera, pairs);
    if (view) append(view->image_points, view->points, view->cam_from_view);
    return;
  }
  std::array<Eigen::Vector3d, kMaxOnStack> rays;
  std::array<Eigen::Vector3d, kMaxOnStack> points;
  std::array<Eigen::Vector2d, kMaxOnStack> image_points;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const std::optional<Eigen::Vector3d> ray = Unproject(camera, pair(i).pixel);
    if (!ray) return;
    rays[i] = *ray;
    points[i] = pair(i).point_in_lidar;
  }
  const std::span<Eigen::Vector2d> image(image_points.data(), sample.size());
  const auto cam_from_view = ProjectRays(std::span(rays).first(sample.size()), image);
  if (cam_from_view) append(image, std::span(points).first(sample.size()), *cam_from_view);
}

}  // namespace sextant
