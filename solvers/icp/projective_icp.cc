// SPDX-License-Identifier: Apache-2.0
#include "solvers/icp/projective_icp.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "geometry/symmetric.h"
#include "solvers/icp/ring_offsets.h"
#include "solvers/kernels/scans/scan_match.h"

namespace sextant {
namespace {

constexpr double kNearer = 0.6;   ///< Ratio of successive gates.
constexpr double kAtRest = 3e-4;  ///< Steps [rad, m] below which matches stay fixed.
constexpr int kMinMatches = 30;
constexpr std::size_t kMinPatches = 30;
/// Relative eigenvalue of the normal matrix, with rotations scaled by the scene's size, below which
/// a motion is undetermined.
constexpr double kMinMotionStiffness = 1e-4;

// Matching in both directions, and the summed normal equations for (dphi, dt) of
// target_from_source.
class TwoWayMatch {
 public:
  TwoWayMatch(const ScanSurfaces& target, const ScanSurfaces& source)
      : forward_(target, source), backward_(source, target) {}

  void Match(const Rigid3d& target_from_source) {
    forward_.Match(target_from_source);
    backward_.Match(target_from_source.Inverse());
  }

  ScanMatch::Equations Linearise(const Rigid3d& target_from_source, double gate_m) const {
    const ScanMatch::Equations there = forward_.Linearise(target_from_source, gate_m);
    const ScanMatch::Equations back = backward_.Linearise(target_from_source.Inverse(), gate_m);
    const Matrix6d by_target = ByTarget(target_from_source);
    const Matrix6d by_source = BySource(target_from_source);
    return {.normal = by_target.transpose() * there.normal * by_target +
                      by_source.transpose() * back.normal * by_source,
            .right = by_target.transpose() * there.right + by_source.transpose() * back.right,
            .squares = there.squares + back.squares,
            .matches = there.matches + back.matches};
  }

  // Both directions use the same returns, so that their noise is almost fully correlated: hence
  // the 2.
  Matrix6d NoiseOfRight(const Rigid3d& target_from_source) const {
    const Matrix6d by_target = ByTarget(target_from_source);
    const Matrix6d by_source = BySource(target_from_source);
    const Matrix6d there = forward_.NoiseOfRight(target_from_source);
    const Matrix6d back = backward_.NoiseOfRight(target_from_source.Inverse());
    return 2.0 *
           (by_target.transpose() * there * by_target + by_source.transpose() * back * by_source);
  }

 private:
  // A rotation dphi of the target about its origin also moves it by dphi x t.
  static Matrix6d ByTarget(const Rigid3d& target_from_source) {
    Matrix6d by_pose = Matrix6d::Identity();
    by_pose.bottomLeftCorner<3, 3>() = Hat(target_from_source.translation);
    return by_pose;
  }

  // A motion of the target is the opposite motion of the source, in the source's frame.
  static Matrix6d BySource(const Rigid3d& target_from_source) {
    const Eigen::Matrix3d back = target_from_source.rotation.toRotationMatrix().transpose();
    Matrix6d by_pose = Matrix6d::Zero();
    by_pose.topLeftCorner<3, 3>() = -back;
    by_pose.bottomRightCorner<3, 3>() = -back;
    return by_pose;
  }

  ScanMatch forward_;
  ScanMatch backward_;
};

Expected<ScanWindows> WindowsOf(std::span<const Eigen::Vector3d> points, const char* frame,
                                double cell_rad) {
  if (points.empty()) {
    return MakeError(ErrorCode::kTooFewPairs,
                     fmt::format("projective icp got no points in the {} frame", frame));
  }
  return ScanWindows(points, cell_rad);
}

// Two passes, as large offsets bias the noise estimate that the first pass uses.
void SubtractRingOffsets(ScanWindows& target, ScanWindows& source) {
  constexpr int kPasses = 2;
  for (int pass = 0; pass < kPasses; ++pass) {
    const RingOffsets offsets = EstimateRingOffsets(target, source);
    if (offsets.target_m.empty() && offsets.source_m.empty()) return;
    if (!offsets.target_m.empty()) target.SubtractOffsets(offsets.target_m);
    if (!offsets.source_m.empty()) source.SubtractOffsets(offsets.source_m);
  }
}

Expected<ScanSurfaces> SurfacesOf(const ScanWindows& windows, std::size_t points,
                                  const char* frame) {
  ScanSurfaces surfaces(windows);
  if (surfaces.patch_count() < kMinPatches) {
    return MakeError(
        ErrorCode::kDegenerate,
        fmt::format("projective icp finds {} flat cells among the {} points in the {} frame, "
                    "expected {} or more: it needs whole scans, seen from the frame's origin; "
                    "match=nearest takes any points",
                    surfaces.patch_count(), points, frame, kMinPatches));
  }
  return surfaces;
}

// The smallest eigenvalue over the largest, with rotations scaled by the scene's size.
double RelativeStiffness(const Matrix6d& normal) {
  const double size = std::sqrt(normal.topLeftCorner<3, 3>().trace() /
                                std::max(normal.bottomRightCorner<3, 3>().trace(), 1e-300));
  Vector6d scale = Vector6d::Ones();
  scale.head<3>().setConstant(1.0 / std::max(size, 1e-300));
  const Matrix6d scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Vector6d ascending = EigenOf(scaled).values;
  return ascending[0] / ascending[5];
}

}  // namespace

Expected<ProjectiveIcpFit> FitProjectiveIcp(std::span<const Eigen::Vector3d> target,
                                            std::span<const Eigen::Vector3d> source,
                                            const Rigid3d& start,
                                            const ProjectiveIcpSettings& settings) {
  SEXTANT_ASSIGN_OR_RETURN(ScanWindows of_target, WindowsOf(target, "camera", settings.cell_rad));
  SEXTANT_ASSIGN_OR_RETURN(ScanWindows of_source, WindowsOf(source, "LiDAR", settings.cell_rad));
  SubtractRingOffsets(of_target, of_source);
  SEXTANT_ASSIGN_OR_RETURN(const ScanSurfaces in_target,
                           SurfacesOf(of_target, target.size(), "camera"));
  SEXTANT_ASSIGN_OR_RETURN(const ScanSurfaces in_source,
                           SurfacesOf(of_source, source.size(), "LiDAR"));
  const double sigma_m = std::max(in_target.range_sigma_m(), in_source.range_sigma_m());

  TwoWayMatch matches(in_target, in_source);
  ProjectiveIcpFit fit;
  fit.target_from_source = start;
  double gate_m = settings.max_distance_m;
  bool at_rest = false;
  ScanMatch::Equations equations;
  while (!fit.converged && fit.iterations < settings.max_iterations) {
    ++fit.iterations;
    if (!at_rest) matches.Match(fit.target_from_source);
    equations = matches.Linearise(fit.target_from_source, gate_m);
    if (equations.matches < kMinMatches) {
      return MakeError(ErrorCode::kNoConsensus,
                       fmt::format("projective icp, iteration {}: {} cells of one scan lie on "
                                   "surfaces of the other, expected {} or more; give a better "
                                   "start, or raise max_distance_m",
                                   fit.iterations, equations.matches, kMinMatches));
    }
    if (RelativeStiffness(equations.normal) < kMinMotionStiffness) {
      return MakeError(ErrorCode::kDegenerate,
                       fmt::format("projective icp, iteration {}: the surfaces seen in both scans "
                                   "leave a motion undetermined",
                                   fit.iterations));
    }
    // Undamped: the matches change with each step, so that there is no fixed cost to lower.
    const Vector6d step = SolveSymmetric(equations.normal, equations.right);
    fit.target_from_source = Perturb(fit.target_from_source, step);
    const double turn_rad = step.head<3>().norm();
    const double move_m = step.tail<3>().norm();
    fit.converged = gate_m == 0.0 && turn_rad <= settings.rotation_tolerance_rad &&
                    move_m <= settings.translation_tolerance_m;
    at_rest = at_rest || (gate_m == 0.0 && turn_rad < kAtRest && move_m < kAtRest);
    gate_m = gate_m * kNearer > sigma_m ? gate_m * kNearer : 0.0;
  }
  fit.matches = equations.matches;
  fit.rmse = std::sqrt(equations.squares / equations.matches);
  const Matrix6d inverse = InvertSymmetric(equations.normal).value();  // See RelativeStiffness.
  fit.covariance = inverse * matches.NoiseOfRight(fit.target_from_source) * inverse;
  return fit;
}

}  // namespace sextant
