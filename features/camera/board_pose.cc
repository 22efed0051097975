// SPDX-License-Identifier: Apache-2.0
#include "features/camera/board_pose.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/board_check.h"
#include "geometry/so3.h"
#include "geometry/symmetric.h"
#include "solvers/least_squares/minimise_pose.h"
#include "solvers/pnp/ippe.h"

namespace sextant {
namespace {

constexpr double kMaxAmbiguity = 9.2;  ///< -2 ln(0.01).

struct Whitened {
  const BoardPoints* points;
  Eigen::LLT<Eigen::MatrixXd> factor;  ///< Cholesky factor of the covariance.
};

struct Equations {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double squares = 0.0;  ///< Chi-square.
  double squares_px2 = 0.0;
};
using Minimum = PoseMinimum<Equations>;

Eigen::Vector3d InBoard(const Eigen::Vector2d& point) { return {point.x(), point.y(), 0.0}; }

// The cost and the normal equations in Perturb's (dphi, dt); false if a point does not project.
bool Evaluate(const Camera& camera, std::span<const Whitened> groups, const Rigid3d& pose,
              Equations& sum) {
  sum = {};
  for (const Whitened& group : groups) {
    const auto n = static_cast<Eigen::Index>(group.points->pixels.size());
    Eigen::VectorXd residual(2 * n);
    Eigen::Matrix<double, Eigen::Dynamic, 6> jacobian(2 * n, 6);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const Eigen::Vector3d turned = pose.rotation * InBoard(group.points->in_board_m[k]);
      const auto image = ProjectWithJacobian(camera, turned + pose.translation);
      if (!image) return false;
      residual.segment<2>(2 * i) = image->pixel - group.points->pixels[k];
      jacobian.block<2, 3>(2 * i, 0) = -image->pixel_by_point * Hat(turned);
      jacobian.block<2, 3>(2 * i, 3) = image->pixel_by_point;
    }
    sum.squares_px2 += residual.squaredNorm();
    group.factor.matrixL().solveInPlace(residual);
    group.factor.matrixL().solveInPlace(jacobian);
    sum.squares += residual.squaredNorm();
    sum.information += jacobian.transpose() * jacobian;
    sum.gradient += jacobian.transpose() * residual;
  }
  return true;
}

Expected<std::vector<Whitened>> Whiten(std::span<const BoardPoints> groups) {
  std::vector<Whitened> whitened;
  for (const BoardPoints& group : groups) {
    const auto n = std::ssize(group.pixels);
    const bool sizes_agree = std::ssize(group.in_board_m) == n &&
                             group.covariance_px2.rows() == 2 * n &&
                             group.covariance_px2.cols() == 2 * n;
    if (!sizes_agree) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("{} points, {} pixels and a covariance of {} x {} do not match",
                                   group.in_board_m.size(), n, group.covariance_px2.rows(),
                                   group.covariance_px2.cols()));
    }
    whitened.push_back({&group, group.covariance_px2.llt()});
    if (whitened.back().factor.info() != Eigen::Success) {
      return MakeError(ErrorCode::kInvalidInput,
                       "the covariance of a board's pixels is not positive definite");
    }
  }
  return whitened;
}

Expected<IppeFit> StartsOf(const Camera& camera, const BoardPoints& group) {
  std::vector<Eigen::Vector2d> image;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < group.pixels.size(); ++i) {
    const std::optional<Eigen::Vector3d> ray = Unproject(camera, group.pixels[i]);
    if (!ray) continue;
    image.emplace_back(ray->hnormalized());
    points.push_back(InBoard(group.in_board_m[i]));
  }
  return SolveIppe(image, points);
}

// Whether two refined poses are the same minimum: those from different initial poses differ by
// rounding.
bool IsSame(const Rigid3d& a, const Rigid3d& b) {
  const PoseDistance distance = DistanceBetween(a, b);
  return distance.rotation_rad < 1e-4 &&
         distance.translation_m < 1e-4 * (1.0 + a.translation.norm());
}

}  // namespace

Expected<BoardPose> EstimateBoardPose(const Camera& camera, std::span<const BoardPoints> groups) {
  if (groups.empty()) {
    return MakeError(ErrorCode::kTooFewPairs, "no tag or checkerboard of the board was seen");
  }
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<Whitened> whitened, Whiten(groups));
  const auto evaluate = [&](const Rigid3d& pose, Equations& sum) {
    return Evaluate(camera, whitened, pose, sum);
  };
  std::vector<Minimum> minima;
  Error failure{ErrorCode::kNoConvergence, "no pose of the board fits its points"};
  for (const BoardPoints& group : groups) {
    const Expected<IppeFit> starts = StartsOf(camera, group);
    if (!starts) {
      failure = starts.error();
      continue;
    }
    for (int i = 0; i < starts->count; ++i) {
      Minimum minimum = MinimisePose<Equations>(
          evaluate, starts->cam_from_lidar[static_cast<std::size_t>(i)], {.max_iterations = 100});
      if (minimum.outcome == RefineOutcome::kConverged ||
          minimum.outcome == RefineOutcome::kStalled) {
        minima.push_back(std::move(minimum));
      }
    }
  }
  if (minima.empty()) return tl::unexpected<Error>(failure);
  const auto chi_square = [](const Minimum& minimum) { return minimum.equations.squares; };
  std::ranges::stable_sort(minima, {}, chi_square);
  const Minimum& best = minima.front();
  const std::optional<Matrix6d> inverse = InvertSymmetric(best.equations.information);
  if (!inverse) {
    return MakeError(ErrorCode::kDegenerate, "the board's points leave its pose undetermined");
  }
  BoardPose pose{.cam_from_board = best.pose, .chi_square = chi_square(best)};
  for (const BoardPoints& group : groups)
    pose.residuals += 2 * static_cast<int>(group.pixels.size());
  pose.rms_px = std::sqrt(2.0 * best.equations.squares_px2 / pose.residuals);
  const double misfit =
      pose.residuals > 6 ? std::max(1.0, chi_square(best) / (pose.residuals - 6)) : 1.0;
  pose.covariance = misfit * *inverse;
  for (const Minimum& other : minima) {
    if (IsSame(other.pose, best.pose)) continue;
    const double worse = (chi_square(other) - chi_square(best)) / misfit;
    if (worse > kMaxAmbiguity) break;
    pose.ambiguous_with = other.pose;
    pose.ambiguity_chi_square = worse;
    break;
  }
  return pose;
}

std::vector<Eigen::Vector3d> BoardCorners(const Board& board) {
  std::vector<Eigen::Vector3d> corners;
  for (const Eigen::Vector2d& corner : CornersInBoard(board)) corners.push_back(InBoard(corner));
  return corners;
}

PointsInCam ToCamera(const BoardPose& pose, std::span<const Eigen::Vector3d> points_in_board) {
  PointsInCam result;
  Eigen::Matrix<double, Eigen::Dynamic, 6> jacobian(3 * std::ssize(points_in_board), 6);
  for (std::size_t i = 0; i < points_in_board.size(); ++i) {
    const Eigen::Vector3d turned = pose.cam_from_board.rotation * points_in_board[i];
    result.points.push_back(turned + pose.cam_from_board.translation);
    const auto at = 3 * static_cast<Eigen::Index>(i);
    jacobian.block<3, 3>(at, 0) = -Hat(turned);
    jacobian.block<3, 3>(at, 3) = Eigen::Matrix3d::Identity();
  }
  result.covariance = jacobian * pose.covariance * jacobian.transpose();
  return result;
}

}  // namespace sextant
