// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "solvers/reprojection_covariance.h"

namespace sextant {
namespace {

// Rays more than 84 deg off the view's axis would dwarf the others on its image plane.
constexpr double kMinRayZ = 0.1;

/// Unit rays onto the image plane of a view that sees them all; how the camera is turned to it.
Expected<Eigen::Quaterniond> ProjectRays(std::span<const Eigen::Vector3d> rays,
                                         std::span<Eigen::Vector2d> image_points) {
  Eigen::Quaterniond cam_from_view = Eigen::Quaterniond::Identity();
  const auto is_wide = [&](const Eigen::Vector3d& ray) {
    return !((cam_from_view.conjugate() * ray).z() > kMinRayZ);
  };
  if (std::any_of(rays.begin(), rays.end(), is_wide)) {
    const Eigen::Vector3d sum =
        std::accumulate(rays.begin(), rays.end(), Eigen::Vector3d(Eigen::Vector3d::Zero()));
    cam_from_view = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), sum);
  }
  if (std::any_of(rays.begin(), rays.end(), is_wide)) {
    return MakeError(ErrorCode::kInvalidInput,
                     "the pixels span more than 168 deg of view, which this solver cannot put on "
                     "one image plane; use p3p or ransac(p3p)");
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    image_points[i] = (cam_from_view.conjugate() * rays[i]).hnormalized();
  }
  return cam_from_view;
}

Expected<PnpPoses> RunKernel(const PnpKernel& kernel, double focal_length_px,
                             std::span<const Eigen::Vector3d> rays,
                             std::span<const Eigen::Vector3d> points,
                             std::span<Eigen::Vector2d> image_points) {
  const Expected<Eigen::Quaterniond> cam_from_view = ProjectRays(rays, image_points);
  if (!cam_from_view) return tl::unexpected<Error>(cam_from_view.error());
  Expected<PnpPoses> found = kernel({image_points, points, focal_length_px});
  if (!found) return found;
  for (Rigid3d& pose : found->poses) pose = Rigid3d{*cam_from_view, Eigen::Vector3d::Zero()} * pose;
  return found;
}

double FocalLength_px(const Camera& camera) { return 0.5 * (camera.fx_px + camera.fy_px); }

}  // namespace

PnpSolver::PnpSolver(SolverSpec spec, PnpKernel kernel, PnpCovariance covariance)
    : Solver(std::move(spec)), kernel_(std::move(kernel)), covariance_(covariance) {}

Expected<PnpPoses> PnpSolver::Run(const Camera& camera, std::span<const Pair2d3d> pairs) const {
  std::vector<Eigen::Vector3d> rays(pairs.size());
  std::vector<Eigen::Vector3d> points(pairs.size());
  std::vector<Eigen::Vector2d> image_points(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::optional<Eigen::Vector3d> ray = Unproject(camera, pairs[i].pixel);
    if (!ray) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("2D-3D pair {} of {}: no ray of the camera model meets pixel "
                                   "({:g}, {:g}); check the pixel and the distortion",
                                   i + 1, pairs.size(), pairs[i].pixel.x(), pairs[i].pixel.y()));
    }
    rays[i] = *ray;
    points[i] = pairs[i].point_in_lidar;
  }
  return RunKernel(kernel_, FocalLength_px(camera), rays, points, image_points);
}

Expected<Estimate> PnpSolver::DoSolve(const CalibrationProblem& problem) const {
  const std::vector<Pair2d3d>& pairs = problem.pairs_2d3d;
  Expected<PnpPoses> found = Run(*problem.camera, pairs);
  if (!found) {
    found.error().message = spec().name + ": " + found.error().message;
    return tl::unexpected<Error>(std::move(found.error()));
  }
  Estimate estimate;
  estimate.cam_from_lidar = found->poses[0];
  estimate.alternatives.assign(found->poses.begin() + 1, found->poses.begin() + found->count);
  estimate.iterations = found->iterations;
  estimate.inliers = std::move(found->inliers);
  if (estimate.inliers.empty()) {
    estimate.inliers.resize(pairs.size());
    std::iota(estimate.inliers.begin(), estimate.inliers.end(), 0);
  }
  estimate.covariance = Covariance(*problem.camera, pairs, estimate);
  return estimate;
}

std::optional<Matrix6d> PnpSolver::Covariance(const Camera& camera, std::span<const Pair2d3d> pairs,
                                              const Estimate& estimate) const {
  if (covariance_ == PnpCovariance::kLeastSquares) {
    std::vector<Pair2d3d> used;
    for (const int i : estimate.inliers) used.push_back(pairs[static_cast<std::size_t>(i)]);
    return ReprojectionCovariance(camera, used, estimate.cam_from_lidar);
  }
  const auto solve = [&](std::span<const Pair2d3d> disturbed) -> std::optional<Rigid3d> {
    const Expected<PnpPoses> found = Run(camera, disturbed);
    if (!found) return std::nullopt;
    // Of several poses, the one that continues the answer.
    const auto distance = [&](const Rigid3d& pose) {
      return PoseDifference(pose, estimate.cam_from_lidar).squaredNorm();
    };
    return *std::min_element(
        found->poses.begin(), found->poses.begin() + found->count,
        [&](const Rigid3d& a, const Rigid3d& b) { return distance(a) < distance(b); });
  };
  return PropagateByDifferences(camera, pairs, estimate.cam_from_lidar, solve);
}

void PnpSolver::DoHypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                              std::vector<Rigid3d>& poses) const {
  constexpr std::size_t kMostOnStack = 64;
  const Camera& camera = *problem.camera;
  const auto pair = [&](std::size_t i) -> const Pair2d3d& {
    return problem.pairs_2d3d[static_cast<std::size_t>(sample[i])];
  };
  const auto append = [&poses](const Expected<PnpPoses>& found) {
    if (!found) return;
    poses.insert(poses.end(), found->poses.begin(), found->poses.begin() + found->count);
  };
  if (sample.size() > kMostOnStack) {
    std::vector<Pair2d3d> pairs;
    for (std::size_t i = 0; i < sample.size(); ++i) pairs.push_back(pair(i));
    append(Run(camera, pairs));
    return;
  }
  std::array<Eigen::Vector3d, kMostOnStack> rays;
  std::array<Eigen::Vector3d, kMostOnStack> points;
  std::array<Eigen::Vector2d, kMostOnStack> image_points;
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const std::optional<Eigen::Vector3d> ray = Unproject(camera, pair(i).pixel);
    if (!ray) return;
    rays[i] = *ray;
    points[i] = pair(i).point_in_lidar;
  }
  append(RunKernel(kernel_, FocalLength_px(camera), std::span(rays).first(sample.size()),
                   std::span(points).first(sample.size()),
                   std::span(image_points).first(sample.size())));
}

}  // namespace sextant
