// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/epnp.h"

#include <Eigen/Geometry>
#include <limits>

#include "solvers/core/registry.h"
#include "solvers/pnp/correspondences.h"
#include "solvers/pnp/depth_kernel.h"
#include "solvers/pnp/nearest_depths.h"
#include "solvers/pnp/pnp_solver.h"

namespace sextant {
namespace {

// Sets thinner than this ratio of standard deviations are also solved as a plane: there pixel noise
// dominates the third axis.
constexpr double kNearlyFlat = 0.05;

/// Tries every start. Returns the error of the best improper rotation.
template <int kAxes>
double SearchAxes(const Correspondences& data, const Rigid3d* near, EpnpCandidate& best) {
  DepthKernel<kAxes> kernel(data, near);
  if (near != nullptr) {
    kernel.SearchNear();
  } else {
    kernel.SearchFromKernel();
    kernel.SearchFromWeakPerspective();
  }
  if (data.frame.different_count == 4) {
    const TrianglePoses found = PosesOfWidestTriangle(data);
    for (int i = 0; i < found.count; ++i) {
      kernel.SearchFrom(found.poses[static_cast<std::size_t>(i)]);
    }
  }
  if (kernel.best().IsBetterThan(best)) best = kernel.best();
  return kernel.MirroredSumSquares();
}

Rigid3d PoseOf(const Correspondences& data, const EpnpCandidate& candidate) {
  Rigid3d pose;
  pose.rotation = Eigen::Quaterniond(candidate.rotation).normalized();
  pose.translation = candidate.centroid - pose.rotation * data.frame.centroid;
  return pose;
}

/// The best candidate over the axes of the points. Returns the error of the best mirror image.
double Search(const Correspondences& data, const Rigid3d* near, EpnpCandidate& best) {
  double mirrored = std::numeric_limits<double>::infinity();
  if (!data.frame.IsPlanar()) mirrored = SearchAxes<3>(data, near, best);
  if (data.frame.deviation.z() < kNearlyFlat * data.frame.deviation.x()) {
    SearchAxes<2>(data, near, best);
  }
  return mirrored;
}

/// Whether the best candidate is a valid solution.
Expected<void> Check(const Correspondences& data, const EpnpCandidate& best, double mirrored) {
  const std::size_t count = data.points.size();
  const double spread = data.moments.Spread() * static_cast<double>(count);
  const bool explained = best.fit.behind <= count / 2 && best.fit.sum_squares <= spread;
  const double error = explained ? best.fit.sum_squares : spread;
  if (error > MirrorRatio(count) * mirrored + 1e-12 * spread) return MirroredError();
  if (!explained) return UnexplainedError();
  return {};
}

}  // namespace

Expected<EpnpFit> SolveEpnp(std::span<const Eigen::Vector2d> image_points,
                            std::span<const Eigen::Vector3d> points_in_lidar,
                            const PnpChoice& choice) {
  constexpr std::size_t kMinPoints = 4;
  SEXTANT_ASSIGN_OR_RETURN(const Correspondences& data,
                           PrepareCorrespondences(image_points, points_in_lidar, kMinPoints));
  EpnpCandidate best;
  const double mirrored = Search(data, choice.near, best);
  if (choice.near != nullptr) {
    best.fit = FitOf(data, best.rotation, best.centroid);
  } else if (!choice.unchecked) {
    SEXTANT_RETURN_IF_ERROR(Check(data, best, mirrored));
  }
  PolishIfExact(data, best.fit, best.rotation, best.centroid);
  EpnpFit fit;
  fit.cam_from_lidar = PoseOf(data, best);
  fit.sum_squares = best.fit.sum_squares;
  return fit;
}

PoseOfMoments EpnpOfMoments(const Correspondences& data, const Rigid3d& near) {
  std::optional<NearestDepths<3>> of_space;
  std::optional<NearestDepths<2>> of_plane;
  if (!data.frame.IsPlanar()) of_space.emplace(data, near);
  if (data.frame.deviation.z() < kNearlyFlat * data.frame.deviation.x())
    of_plane.emplace(data, near);
  const bool is_plane =
      of_plane && (!of_space || of_plane->candidate().IsBetterThan(of_space->candidate()));
  const auto pose_by = [&data](const auto& depths) -> PoseOfMoments {
    if (!depths.found()) return {};
    return [&data, depths](const ImageMoments& moments) -> std::optional<Rigid3d> {
      const std::optional<EpnpCandidate> candidate = depths.At(moments);
      if (!candidate) return std::nullopt;
      return PoseOf(data, *candidate);
    };
  };
  return is_plane ? pose_by(*of_plane) : pose_by(*of_space);
}

SolverEntry EpnpEntry() {
  return {
      .name = "epnp",
      .summary = "pose from control points: kernel of the linear equations, then their lengths",
      .needs = "4 or more 2D-3D pairs, not on one line",
      .reference = "Lepetit, Moreno-Noguer and Fua 2009 (IJCV)",
      .example = "epnp",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return std::make_shared<PnpSolver>(
            SolverSpec{.name = arguments.name, .needs = {.pairs_2d3d = 4}},
            [](const PnpInput& input) -> Expected<PnpPoses> {
              SEXTANT_ASSIGN_OR_RETURN(const EpnpFit fit,
                                       SolveEpnp(input.image_points, input.points, input.choice));
              return PnpPoses{.poses = {fit.cam_from_lidar}, .count = 1};
            },
            EpnpOfMoments);
      },
  };
}

}  // namespace sextant
