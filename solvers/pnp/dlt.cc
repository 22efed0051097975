// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/dlt.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <optional>

#include "geometry/symmetric.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/max_trace_rotation.h"
#include "solvers/pnp/correspondences.h"
#include "solvers/pnp/pnp_solver.h"

namespace sextant {
namespace {

constexpr int kMinDltPoints = 6;

// In sets thinner than this share of their length, rounding determines the third axis.
constexpr double kMinThickness = 1e-5;

// Two null directions with a smaller gap of eigenvalues are indistinguishable.
constexpr double kMinRelativeGap = 1e-13;

/// The moments in coordinates (1, p) of unit covariance, and the problem that the depths solve.
struct UnitMoments {
  UnitMoments(const PointCloudFrame& frame, const ImageMoments& moments) {
    Eigen::Vector4d to_unit;
    to_unit << 1.0, frame.deviation.cwiseInverse();
    u = to_unit.asDiagonal() * moments.u * to_unit.asDiagonal();
    v = to_unit.asDiagonal() * moments.v * to_unit.asDiagonal();
    reduced = to_unit.asDiagonal() * moments.w * to_unit.asDiagonal();
    reduced -= u * u + v * v;
  }

  Eigen::Matrix4d u, v, reduced;
};

/// The nearest pose to the projection with these depths of (1, p).
Expected<Rigid3d> PoseOf(const PointCloudFrame& frame, const ImageMoments& moments,
                         const UnitMoments& unit, Eigen::Vector4d depth) {
  if (depth(0) < 0.0) depth = -depth;
  Eigen::Matrix<double, 3, 4> model;
  model.row(0) = unit.u * depth + moments.mean.x() * depth;
  model.row(1) = unit.v * depth + moments.mean.y() * depth;
  model.row(2) = depth;
  const Eigen::Matrix3d linear =
      model.rightCols<3>() * frame.deviation.cwiseInverse().asDiagonal() * frame.axes.transpose();
  if (linear.determinant() < 0.0) {
    return MakeError(ErrorCode::kMirrored,
                     "a mirror image fits better than any pose in front of the camera; check the "
                     "pairing, the axes and that the points are in front of the camera");
  }
  const auto nearest = MaximizeTrace(linear.transpose(), 2.0 * linear.norm());
  if (!nearest) {
    return MakeError(ErrorCode::kDegenerate, "the linear projection has no nearest rotation");
  }
  const double scale = nearest->trace / 3.0;
  return Rigid3d{nearest->rotation, model.col(0) / scale - nearest->rotation * frame.centroid};
}

Expected<Rigid3d> PoseOf(const Correspondences& data) {
  const PointCloudFrame& frame = data.frame;
  const double thickness = frame.deviation.z() / frame.deviation.x();
  if (!(thickness > kMinThickness)) {
    return MakeError(ErrorCode::kDegenerate,
                     fmt::format("the points lie on one plane (deviation from it {:.1g} of their "
                                 "extent), which leaves the linear projection undetermined; use "
                                 "ippe, epnp or sqpnp, or points off the plane",
                                 thickness));
  }
  const UnitMoments unit(frame, data.moments);
  const SymmetricEigen<4> eigen = EigenOf(unit.reduced);
  const Eigen::Vector4d& lambda = eigen.values;
  if (!(lambda(1) - lambda(0) > kMinRelativeGap * lambda(3))) {
    return MakeError(ErrorCode::kDegenerate,
                     "the points and the camera lie on a surface that leaves the linear "
                     "projection undetermined; add points, or use epnp or sqpnp");
  }
  return PoseOf(frame, data.moments, unit, eigen.vectors.col(0));
}

/// PoseOf with the first-order perturbation of the depths, reduced z = lambda z, instead of another
/// decomposition.
PoseOfMoments DltOfMoments(const Correspondences& data, const Rigid3d&) {
  const UnitMoments unit(data.frame, data.moments);
  const SymmetricEigen<4> eigen = EigenOf(unit.reduced);
  return [&data, unit, eigen](const ImageMoments& moments) -> std::optional<Rigid3d> {
    const UnitMoments displaced(data.frame, moments);
    const Eigen::Matrix4d& vectors = eigen.vectors;
    Eigen::Vector4d depth = vectors.col(0);
    const Eigen::Vector4d moved =
        vectors.transpose() * ((displaced.reduced - unit.reduced) * depth);
    for (int k = 1; k < 4; ++k) {
      depth += moved(k) / (eigen.values(0) - eigen.values(k)) * vectors.col(k);
    }
    const Expected<Rigid3d> pose = PoseOf(data.frame, moments, displaced, depth);
    if (!pose) return std::nullopt;
    return *pose;
  };
}

}  // namespace

Expected<Rigid3d> SolveDlt(std::span<const Eigen::Vector2d> image_points,
                           std::span<const Eigen::Vector3d> points_in_lidar) {
  SEXTANT_ASSIGN_OR_RETURN(const Correspondences& data,
                           PrepareCorrespondences(image_points, points_in_lidar, kMinDltPoints));
  return PoseOf(data);
}

SolverEntry DltEntry() {
  return {
      .name = "dlt",
      .summary = "linear projection matrix, then the nearest rotation: the naive baseline",
      .needs = "6 or more 2D-3D pairs, not on one plane",
      .reference = "Abdel-Aziz and Karara 1971; Hartley and Zisserman 2004, section 7.1",
      .example = "dlt",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        const auto kernel = [](const PnpInput& input) -> Expected<PnpPoses> {
          SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose, SolveDlt(input.image_points, input.points));
          return PnpPoses{.poses = {pose}, .count = 1};
        };
        return std::make_shared<PnpSolver>(
            SolverSpec{.name = arguments.name, .needs = {.pairs_2d3d = kMinDltPoints}}, kernel,
            DltOfMoments);
      },
  };
}

}  // namespace sextant
