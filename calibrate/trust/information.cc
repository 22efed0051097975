// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/information.h"

#include <fmt/core.h>

#include <cmath>

#include "base/units.h"
#include "calibrate/trust/stated_covariance.h"
#include "geometry/symmetric.h"
#include "solvers/core/board_view_check.h"
#include "solvers/joint/board_view_information.h"

namespace sextant {
namespace {

struct Weakest3 {
  Eigen::Vector3d axis;
  double sigma;
};

Weakest3 WeakestOf3(const Eigen::Matrix3d& covariance) {
  const SymmetricEigen<3> eigen = EigenOf(covariance);
  return {eigen.vectors.col(2), std::sqrt(std::max(0.0, eigen.values[2]))};
}

std::optional<Matrix6d> InformationOf(const CalibrationProblem& problem, int view,
                                      const Rigid3d& cam_from_lidar) {
  std::optional<Matrix6d> sum;
  for (const BoardView& seen : problem.board_views) {
    const Board* board = FindBoard(problem.boards, seen.board);
    if (seen.view != view || board == nullptr || !problem.camera) continue;
    const Expected<Matrix6d> information =
        InformationOfView(seen, *board, *problem.camera, cam_from_lidar, seen.cam_from_board);
    if (information) sum = sum.value_or(Matrix6d::Zero()) + *information;
  }
  return sum;
}

// T with T * sum * T = the inverse of the stated covariance; the identity where there is none.
Matrix6d ToStated(const Matrix6d& sum, const std::optional<Matrix6d>& covariance) {
  const std::optional<Matrix6d> target =
      covariance ? InvertSymmetric<6>(*covariance) : std::nullopt;
  if (!target) return Matrix6d::Identity();
  return CongruenceTo(sum, *target).value_or(Matrix6d::Identity());
}

}  // namespace

WeakestDirections WeakestOf(const Matrix6d& covariance) {
  const Weakest3 rotation = WeakestOf3(covariance.topLeftCorner<3, 3>());
  const Weakest3 translation = WeakestOf3(covariance.bottomRightCorner<3, 3>());
  return {.translation_axis_in_cam = translation.axis,
          .translation_sigma_m = translation.sigma,
          .rotation_axis_in_cam = rotation.axis,
          .rotation_sigma_rad = rotation.sigma};
}

std::string AxisName(const Eigen::Vector3d& axis) {
  constexpr const char* kNames[] = {"right-left", "down-up", "forward"};
  const double within = std::cos(25.0 * kRadPerDeg);
  for (int i = 0; i < 3; ++i) {
    if (std::abs(axis[i]) > within) return kNames[i];
  }
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", axis.x(), axis.y(), axis.z());
}

std::string DescribeWeakest(const WeakestDirections& weakest) {
  return fmt::format("translation {} {:.2g} mm, rotation about {} {:.2g} deg",
                     AxisName(weakest.translation_axis_in_cam), weakest.translation_sigma_m * 1e3,
                     AxisName(weakest.rotation_axis_in_cam),
                     weakest.rotation_sigma_rad / kRadPerDeg);
}

std::optional<Matrix6d> CovarianceOf(const Matrix6d& information) {
  // Radians and metres are scaled alike before singularity is tested.
  constexpr double kSmallestEigenvalue = 1e-9;
  if (!(information.diagonal().minCoeff() > 0.0)) return std::nullopt;
  const Vector6d scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const SymmetricEigen<6> eigen = EigenOf<6>(scale.asDiagonal() * information * scale.asDiagonal());
  if (!(eigen.values[0] > kSmallestEigenvalue)) return std::nullopt;
  const Matrix6d root = scale.asDiagonal() * eigen.vectors;
  const Vector6d inverse = eigen.values.cwiseInverse();
  const Matrix6d covariance = root * inverse.asDiagonal() * root.transpose();
  return 0.5 * (covariance + covariance.transpose());
}

void AddInformation(const CalibrationProblem& problem, CalibrationResult& result) {
  Matrix6d sum = Matrix6d::Zero();
  for (ResultView& view : result.views) {
    if (!view.kept) continue;
    view.information = InformationOf(problem, view.view, result.cam_from_lidar);
    if (view.information) sum += *view.information;
  }
  const Matrix6d to_stated = ToStated(sum, result.covariance);
  sum.setZero();
  for (ResultView& view : result.views) {
    if (!view.information) continue;
    const Matrix6d stated = to_stated * *view.information * to_stated;
    view.information = 0.5 * (stated + stated.transpose());
    sum += *view.information;
    const std::optional<Matrix6d> covariance = CovarianceOf(sum);
    if (covariance) view.sigma_so_far = covariance->diagonal().cwiseSqrt();
  }
}

}  // namespace sextant
