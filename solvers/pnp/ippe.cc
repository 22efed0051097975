// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/ippe.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/so3.h"
#include "solvers/core/registry.h"
#include "solvers/pnp/plane_frame.h"
#include "solvers/pnp/plane_image_moments.h"
#include "solvers/pnp/pnp_solver.h"

namespace sextant {
namespace {

constexpr std::size_t kMinPoints = 4;

using Moments = PlaneImageMoments;

// The eigenvector of the smallest eigenvalue, accurate enough as a start. The adjugate has the same
// eigenvectors, and there the one sought has by far the largest eigenvalue.
struct NullDirection {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  double gap = 0.0;  // Product of the other eigenvalues over their squared sum: 0 to 1/4.
};

NullDirection FindNullDirection(const Eigen::Matrix3d& q) {
  Eigen::Matrix3d adjugate;
  adjugate.col(0) = q.col(1).cross(q.col(2));
  adjugate.col(1) = q.col(2).cross(q.col(0));
  adjugate.col(2) = q.col(0).cross(q.col(1));
  const double scale = adjugate.trace();
  const Eigen::Matrix3d square = adjugate * adjugate / (scale * scale);
  Eigen::Index widest = 0;
  square.diagonal().maxCoeff(&widest);
  return {square.col(widest), scale / (q.trace() * q.trace())};
}

// Whether points of a plane determine a homography. Three of four on a line, or a duplicated point,
// do not, but pixel noise hides that. The test therefore uses the points as their own image: the
// homography is then the identity, and any other solution shows in the upper left block.
bool FixHomography(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& centroid,
                   const Eigen::Matrix<double, 2, 3>& unit_from_points) {
  constexpr double kMinRelativeDeterminant = 1e-12;
  constexpr double kMinReduced = 1e-6;
  Eigen::Matrix3d u = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d v = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d a = (unit_from_points * (p - centroid)).homogeneous();
    const Eigen::Matrix3d outer = a * a.transpose();
    u += a.x() * outer;
    v += a.y() * outer;
    square += (a.x() * a.x() + a.y() * a.y()) * outer;
  }
  const Eigen::Matrix3d reduced = square - (u * u + v * v) / static_cast<double>(points.size());
  const double determinant = reduced(0, 0) * reduced(1, 1) - reduced(0, 1) * reduced(1, 0);
  // With three points all of the remainder is rounding.
  const double size = std::max(reduced.trace(), kMinReduced * square.trace());
  return determinant > kMinRelativeDeterminant * size * size;
}

// The two rotations of the plane z = 0 whose image at the plane's origin has value (h02, h12) / h22
// and the derivative of the homography there.
std::array<Eigen::Matrix3d, 2> InfinitesimalRotations(const Eigen::Matrix3d& h) {
  const Eigen::Vector2d value = h.topRightCorner<2, 1>() / h(2, 2);
  const Eigen::Matrix2d jacobian =
      (h.topLeftCorner<2, 2>() - value * h.bottomLeftCorner<1, 2>()) / h(2, 2);
  const Eigen::Matrix3d cam_from_ray =
      RotationBetween(Eigen::Vector3d::UnitZ(), value.homogeneous()).toRotationMatrix();
  const Eigen::Matrix2d turned =
      cam_from_ray.topLeftCorner<2, 2>() - value * cam_from_ray.bottomLeftCorner<1, 2>();
  const Eigen::Matrix2d stretched = turned.inverse() * jacobian;
  // The larger singular value of a 2x2 matrix.
  const double sum =
      Eigen::Vector2d(stretched(0, 0) + stretched(1, 1), stretched(1, 0) - stretched(0, 1)).norm();
  const double difference =
      Eigen::Vector2d(stretched(0, 0) - stretched(1, 1), stretched(1, 0) + stretched(0, 1)).norm();
  const Eigen::Matrix2d upper = stretched * (2.0 / (sum + difference));
  const double b0 = std::sqrt(std::max(0.0, 1.0 - upper.col(0).squaredNorm()));
  const double b1 = std::copysign(std::sqrt(std::max(0.0, 1.0 - upper.col(1).squaredNorm())),
                                  -upper.col(0).dot(upper.col(1)));
  std::array<Eigen::Matrix3d, 2> rotations;
  for (const double side : {1.0, -1.0}) {
    Eigen::Matrix3d ray_from_plane;
    ray_from_plane.col(0) << upper.col(0), side * b0;
    ray_from_plane.col(1) << upper.col(1), side * b1;
    ray_from_plane.col(2) = ray_from_plane.col(0).cross(ray_from_plane.col(1));
    rotations[side > 0.0 ? 0 : 1] = cam_from_ray * ray_from_plane;
  }
  return rotations;
}

// The algebraic error as a function of the rotation alone. The best translation is linear in the
// first two columns of the plane's rotation, so that the error is a constant quadratic form of
// these: (Y1, Y2)^T [A B; B^T C] (Y1, Y2) with Y = T R, where T maps to the normalised image, (x,
// y, z) to
// (((x, y) - z centre) / size, z). There the block of the translation is n times the identity.
class AlgebraicError {
 public:
  AlgebraicError(const Moments& moments, const Eigen::Vector2d& extent)
      : centre_(moments.centre), size_(moments.size) {
    const double n = moments.count;
    to_origin_[0] = -extent.x() / n * Block(moments, 2, 0);
    to_origin_[1] = -extent.y() / n * Block(moments, 2, 1);
    a_ = extent.x() * extent.x() * Block(moments, 0, 0) - n * to_origin_[0] * to_origin_[0];
    b_ = extent.x() * extent.y() * Block(moments, 0, 1) - n * to_origin_[0] * to_origin_[1];
    c_ = extent.y() * extent.y() * Block(moments, 1, 1) - n * to_origin_[1] * to_origin_[1];
  }

  // The plane's origin in the camera frame for a rotation.
  Eigen::Vector3d BestOrigin(const Eigen::Matrix3d& cam_from_plane) const {
    const Eigen::Matrix3d y = Normalise(cam_from_plane);
    const Eigen::Vector3d origin = to_origin_[0] * y.col(0) + to_origin_[1] * y.col(1);
    return {size_ * origin.x() + centre_.x() * origin.z(),
            size_ * origin.y() + centre_.y() * origin.z(), origin.z()};
  }

  // The nearest minimum by Newton's method: three unknowns with an exact Hessian, which need no
  // damping. After a last step under the tolerance the error is of the order of its square.
  Eigen::Quaterniond Minimise(Eigen::Quaterniond cam_from_plane) const {
    constexpr int kMaxSteps = 10;
    constexpr double kTolerance = 3e-5;
    for (int step = 0; step < kMaxSteps; ++step) {
      const Eigen::Vector3d psi = Step(Normalise(cam_from_plane.toRotationMatrix()));
      // Exp(psi) to first order suffices, as psi converges to 0.
      const Eigen::Quaterniond turn(1.0, 0.5 * psi.x(), 0.5 * psi.y(), 0.5 * psi.z());
      cam_from_plane = (cam_from_plane * turn).normalized();
      if (!(psi.squaredNorm() > kTolerance * kTolerance)) break;
    }
    return cam_from_plane;
  }

 private:
  // The block of columns k and l in the quadratic form of the normalised homography.
  static Eigen::Matrix3d Block(const Moments& moments, int k, int l) {
    const double n = k == l ? moments.count : 0.0;
    Eigen::Matrix3d block;
    block << n, 0.0, -moments.u(k, l), 0.0, n, -moments.v(k, l), -moments.u(k, l), -moments.v(k, l),
        moments.square(k, l);
    return block;
  }

  Eigen::Matrix3d Normalise(const Eigen::Matrix3d& rotation) const {
    Eigen::Matrix3d y = rotation;
    y.row(0) = (rotation.row(0) - centre_.x() * rotation.row(2)) / size_;
    y.row(1) = (rotation.row(1) - centre_.y() * rotation.row(2)) / size_;
    return y;
  }

  // The rotation vector psi in R Exp(psi). To second order Y1 moves by psi_3 Y2 - psi_2 Y3 + (psi_1
  // Y psi - |psi|^2 Y1) / 2, and Y2 by psi_1 Y3 - psi_3 Y1 + (psi_2 Y psi - |psi|^2 Y2) / 2.
  Eigen::Vector3d Step(const Eigen::Matrix3d& y) const {
    const Eigen::Vector3d y1 = y.col(0);
    const Eigen::Vector3d y2 = y.col(1);
    const Eigen::Vector3d y3 = y.col(2);
    const Eigen::Vector3d force1 = y.transpose() * (a_ * y1 + b_ * y2);
    const Eigen::Vector3d force2 = y.transpose() * (b_.transpose() * y1 + c_ * y2);
    const Eigen::Vector3d gradient(force2.z(), -force1.z(), force1.y() - force2.x());

    const Eigen::Vector3d turned1 = a_ * y2 - b_ * y1;
    const Eigen::Vector3d turned2 = b_.transpose() * y2 - c_ * y1;
    Hessian gauss_newton;
    gauss_newton.xx = y3.dot(c_ * y3);
    gauss_newton.xy = -y3.dot(b_ * y3);
    gauss_newton.yy = y3.dot(a_ * y3);
    gauss_newton.xz = y3.dot(turned2);
    gauss_newton.yz = -y3.dot(turned1);
    gauss_newton.zz = y2.dot(turned1) - y1.dot(turned2);

    Hessian newton = gauss_newton;
    newton.xx -= force2.y();
    newton.yy -= force1.x();
    newton.zz -= force1.x() + force2.y();
    newton.xy += 0.5 * (force1.y() + force2.x());
    newton.xz += 0.5 * force1.z();
    newton.yz += 0.5 * force2.z();
    Eigen::Vector3d psi = Eigen::Vector3d::Zero();
    // Where the error is not convex Newton's step may increase it; the Gauss-Newton step does not.
    if (!newton.Solve(-gradient, psi)) gauss_newton.Solve(-gradient, psi);
    return psi;
  }

  struct Hessian {
    double xx, xy, xz, yy, yz, zz;

    // False, and `solution` unchanged, where it is not positive definite.
    bool Solve(const Eigen::Vector3d& right, Eigen::Vector3d& solution) const {
      const Eigen::Vector3d first(yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
      const double minor = xx * yy - xy * xy;
      const double determinant = xx * first.x() + xy * first.y() + xz * first.z();
      if (!(xx > 0.0 && minor > 0.0 && determinant > 0.0)) return false;
      const double mixed = xy * xz - xx * yz;
      const Eigen::Vector3d second(first.y(), xx * zz - xz * xz, mixed);
      const Eigen::Vector3d third(first.z(), mixed, minor);
      solution =
          Eigen::Vector3d(first.dot(right), second.dot(right), third.dot(right)) / determinant;
      return true;
    }
  };

  Eigen::Vector2d centre_;
  double size_;
  Eigen::Matrix3d to_origin_[2];
  Eigen::Matrix3d a_, b_, c_;
};

// Infinite where a point is behind the camera.
double SumSquares(const Rigid3d& pose, std::span<const Eigen::Vector2d> image_points,
                  std::span<const Eigen::Vector3d> points) {
  const ImageFit fit =
      FitOf(image_points, points, pose.rotation.toRotationMatrix(), pose.translation);
  return fit.behind > 0 ? std::numeric_limits<double>::infinity() : fit.sum_squares;
}

// Adds a pose in front of the camera. Where both starts end in the same minimum, the better one is
// kept.
void AddDifferent(const Rigid3d& pose, double sum_squares, IppeFit& fit) {
  // Cosine of half an angle of 1e-5 rad.
  constexpr double kSameCosine = 1.0 - 1.25e-11;
  if (!std::isfinite(sum_squares)) return;
  std::size_t slot = static_cast<std::size_t>(fit.count);
  if (slot == 1 && std::abs(pose.rotation.dot(fit.cam_from_lidar[0].rotation)) > kSameCosine) {
    if (!(sum_squares < fit.sum_squares[0])) return;
    slot = 0;
  }
  fit.cam_from_lidar[slot] = pose;
  fit.sum_squares[slot] = sum_squares;
  fit.count = static_cast<int>(slot) + 1;
}

}  // namespace

Expected<IppeFit> SolveIppe(std::span<const Eigen::Vector2d> image_points,
                            std::span<const Eigen::Vector3d> points_in_lidar) {
  if (points_in_lidar.size() < kMinPoints) {
    return MakeError(ErrorCode::kTooFewPairs, fmt::format("ippe needs at least {} pairs, got {}",
                                                          kMinPoints, points_in_lidar.size()));
  }
  SEXTANT_ASSIGN_OR_RETURN(const PlaneFrame frame, FramePlane(points_in_lidar));
  const Eigen::Vector2d extent = frame.deviation.head<2>();
  const Eigen::Matrix<double, 2, 3> unit_from_lidar =
      extent.cwiseInverse().asDiagonal() * frame.axes.leftCols<2>().transpose();
  const Moments moments(image_points, points_in_lidar, frame.centroid, unit_from_lidar);
  const Eigen::Matrix3d reduced = moments.Reduced();
  const NullDirection depth = FindNullDirection(reduced);
  constexpr double kMinGap = 1e-13;
  // Three points fit any direction: the remainder is rounding.
  constexpr double kMinLeft = 1e-13;
  constexpr double kGapOfNoise = 0.03;
  if (!(reduced.trace() > kMinLeft * moments.square.trace()) || !(depth.gap > kMinGap) ||
      (depth.gap < kGapOfNoise &&
       !FixHomography(points_in_lidar, frame.centroid, unit_from_lidar))) {
    return MakeError(ErrorCode::kDegenerate,
                     "fewer than four pixels or points differ, or three of four are on one "
                     "line, which leaves the plane's pose undetermined; use four that span a "
                     "quadrilateral");
  }
  Eigen::Matrix3d homography = moments.Homography(depth.direction);
  homography.leftCols<2>() *= extent.cwiseInverse().asDiagonal();

  const AlgebraicError error(moments, extent);
  const Eigen::Quaterniond plane_from_lidar(Eigen::Matrix3d(frame.axes.transpose()));
  IppeFit fit;
  for (const Eigen::Matrix3d& start : InfinitesimalRotations(homography)) {
    const Eigen::Quaterniond cam_from_plane = error.Minimise(Eigen::Quaterniond(start));
    Rigid3d pose;
    pose.rotation = (cam_from_plane * plane_from_lidar).normalized();
    pose.translation =
        error.BestOrigin(cam_from_plane.toRotationMatrix()) - pose.rotation * frame.centroid;
    AddDifferent(pose, SumSquares(pose, image_points, points_in_lidar), fit);
  }
  if (fit.count == 0) {
    return MakeError(ErrorCode::kMirrored,
                     "no pose in front of the camera explains the plane's image; check the order "
                     "of the points and that they are in front of the camera");
  }
  if (fit.count == 2 && fit.sum_squares[1] < fit.sum_squares[0]) {
    std::swap(fit.cam_from_lidar[0], fit.cam_from_lidar[1]);
    std::swap(fit.sum_squares[0], fit.sum_squares[1]);
  }
  return fit;
}

SolverEntry IppeEntry() {
  return {
      .name = "ippe",
      .summary = "both poses of a plane from the first order of its homography, each polished",
      .needs = "4 or more 2D-3D pairs on one plane, not three of four on one line",
      .reference = "Collins and Bartoli 2014 (IJCV 109)",
      .example = "ippe",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        const auto kernel = [](const PnpInput& input) -> Expected<PnpPoses> {
          SEXTANT_ASSIGN_OR_RETURN(const IppeFit fit, SolveIppe(input.image_points, input.points));
          PnpPoses poses{.poses = {}, .count = fit.count};
          std::copy_n(fit.cam_from_lidar.begin(), fit.count, poses.poses.begin());
          return poses;
        };
        return std::make_shared<PnpSolver>(
            SolverSpec{.name = arguments.name, .needs = {.pairs_2d3d = 4, .points_on_plane = true}},
            kernel, PnpCovariance::kObjectSpace);
      },
  };
}

}  // namespace sextant
