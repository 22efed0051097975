// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/metrics.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "base/units.h"
#include "solvers/icp/point_tree.h"

namespace sextant {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double MeanOfFinite(std::span<const double> values) {
  double sum = 0.0;
  int count = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  return count > 0 ? sum / count : kNone;
}

void MeasureResiduals(const Evaluation& evaluation, MetricValues& values) {
  if (evaluation.rmse_m) values.Set(kRmseMm, *evaluation.rmse_m * 1e3);
  if (evaluation.rmse_px) values.Set(kRmsePx, *evaluation.rmse_px);
  if (values.Wants(kMeanPx)) values.Set(kMeanPx, MeanOfFinite(evaluation.per_pair_px));
}

void MeasureHeldOut(const CalibrationProblem& held_out, const Rigid3d& cam_from_lidar,
                    MetricValues& values) {
  if (!values.Wants(kHeldOutMm) && !values.Wants(kHeldOutPx)) return;
  const Evaluation evaluation = Evaluate(held_out, cam_from_lidar);
  if (evaluation.rmse_m) values.Set(kHeldOutMm, *evaluation.rmse_m * 1e3);
  if (evaluation.rmse_px) values.Set(kHeldOutPx, *evaluation.rmse_px);
}

void MeasureEstimate(const Rigid3d& cam_from_lidar, MetricValues& values) {
  values.Set(kEstimatedXM, cam_from_lidar.translation.x());
  values.Set(kEstimatedYM, cam_from_lidar.translation.y());
  values.Set(kEstimatedZM, cam_from_lidar.translation.z());
  if (!values.Wants(kEstimatedYawDeg) && !values.Wants(kEstimatedPitchDeg) &&
      !values.Wants(kEstimatedRollDeg)) {
    return;
  }
  const EulerZyx euler = ToEulerZyx(cam_from_lidar.rotation);
  values.Set(kEstimatedYawDeg, euler.yaw * kDegPerRad);
  values.Set(kEstimatedPitchDeg, euler.pitch * kDegPerRad);
  values.Set(kEstimatedRollDeg, euler.roll * kDegPerRad);
}

bool IsBeyond(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
  return error.norm() > 3.0 * std::sqrt(std::max(0.0, covariance.trace()));
}

void MeasureUncertainty(const SolveReport& report, const Rigid3d& truth, MetricValues& values) {
  if (!report.covariance) return;
  const Matrix6d& covariance = *report.covariance;
  values.Set(kOverconfident, IsOverconfident(report.cam_from_lidar, covariance, truth) ? 1.0 : 0.0);
  if (!values.Wants(kNees) && !values.Wants(kCovered)) return;
  constexpr double kChiSquare6 = 12.591587243743977;  // Quantile at 0.95, 6 degrees of freedom.
  const double nees = Nees(report.cam_from_lidar, covariance, truth);
  values.Set(kNees, nees);
  if (std::isfinite(nees)) values.Set(kCovered, nees <= kChiSquare6 ? 1.0 : 0.0);
}

void MeasureError(const Rigid3d& cam_from_lidar, const Rigid3d& truth, const PoseLimits& limits,
                  MetricValues& values) {
  const PoseDistance off = DistanceBetween(cam_from_lidar, truth);
  const double rotation_deg = off.rotation_rad * kDegPerRad;
  const double translation_mm = off.translation_m * 1e3;
  const Eigen::Vector3d by_axis_mm = 1e3 * (cam_from_lidar.translation - truth.translation);
  const bool success = rotation_deg <= limits.success_deg && translation_mm <= limits.success_mm;
  values.Set(kFine, rotation_deg <= limits.gross_deg ? 1.0 : 0.0);
  values.Set(kSuccess, success ? 1.0 : 0.0);
  values.Set(kWrong, success ? 0.0 : 1.0);
  values.Set(kRotationDeg, rotation_deg);
  values.Set(kTranslationMm, translation_mm);
  values.Set(kXMm, by_axis_mm.x());
  values.Set(kYMm, by_axis_mm.y());
  values.Set(kZMm, by_axis_mm.z());
}

}  // namespace

const std::vector<Metric>& PoseMetrics() {
  static const std::vector<Metric> metrics = {
      {"answered", "1 if the solver returned a pose, 0 if it returned an error"},
      {"fine",
       "1 if the rotation is within gross_deg of the truth, so that only noise remains; else 0"},
      {"success", "1 if the pose is within success_deg and success_mm of the truth; else 0"},
      {"wrong", "1 if there is a pose but it is no success; else 0"},
      {"rotation_deg", "geodesic angle between the estimated and the true rotation"},
      {"translation_mm", "distance between the estimated and the true translation"},
      {"x_mm", "error of the translation along the camera's x axis"},
      {"y_mm", "error of the translation along the camera's y axis"},
      {"z_mm", "error of the translation along the camera's z axis"},
      {"bound_rotation_deg", "Cramer-Rao bound of the RMS of rotation_deg, from the true inliers"},
      {"bound_translation_mm",
       "Cramer-Rao bound of the RMS of translation_mm, from the true inliers"},
      {"nees", "squared error in units of the stated covariance; 6 on average if that is right"},
      {"covered",
       "1 if the truth is in the region that holds it with 95 percent by the stated covariance"},
      {"overconfident",
       "1 if the error of rotation or translation is over three times its stated sigma; else 0"},
      {"rmse_mm", "RMS residual of the 3D-3D pairs given to the solver"},
      {"nearest_mm", "RMS distance to the nearest point of the other sensor, ignoring the pairing"},
      {"rmse_px", "RMS reprojection error of the 2D-3D pairs given to the solver"},
      {"mean_px", "mean reprojection error of the same pairs"},
      {"held_out_mm", "RMS residual of 3D-3D pairs withheld from the solver"},
      {"held_out_px", "RMS reprojection error of 2D-3D pairs withheld from the solver"},
      {"inliers", "number of pairs that the estimate uses"},
      {"estimated_x_m", "x of the estimated translation of cam_from_lidar"},
      {"estimated_y_m", "y of the estimated translation of cam_from_lidar"},
      {"estimated_z_m", "z of the estimated translation of cam_from_lidar"},
      {"estimated_yaw_deg", "yaw of cam_from_lidar, R = Rz(yaw) Ry(pitch) Rx(roll)"},
      {"estimated_pitch_deg", "pitch of cam_from_lidar"},
      {"estimated_roll_deg", "roll of cam_from_lidar"},
      {"time_us", "wall time of the solver; measured by timed_trials and not part of the rows"},
  };
  return metrics;
}

void MeasurePose(const KnownProblem& known, const Expected<SolveReport>& report,
                 const PoseLimits& limits, MetricValues values) {
  values.Set(kAnswered, report ? 1.0 : 0.0);
  values.Set(kFine, 0.0);
  values.Set(kSuccess, 0.0);
  values.Set(kWrong, 0.0);
  if (!report) return;
  const Rigid3d& pose = report->cam_from_lidar;
  MeasureError(pose, known.cam_from_lidar, limits, values);
  MeasureResiduals(report->evaluation, values);
  MeasureHeldOut(known.held_out, pose, values);
  MeasureEstimate(pose, values);
  values.Set(kTimeUs, report->wall_time_us);
  values.Set(kInliers, static_cast<double>(report->inliers.size()));
  MeasureUncertainty(*report, known.cam_from_lidar, values);
  if (values.Wants(kNearestMm) && !known.problem.pairs_3d3d.empty()) {
    values.Set(kNearestMm, 1e3 * NearestNeighbourRmse(PointsOf(known.problem.pairs_3d3d), pose));
  }
}

double NearestNeighbourRmse(const PointSets& sets, const Rigid3d& cam_from_lidar) {
  const PointTree tree(sets.in_cam);
  double sum = 0.0;
  for (const Eigen::Vector3d& point : sets.in_lidar) {
    constexpr double kAnywhere = std::numeric_limits<double>::max();
    sum += tree.Nearest(cam_from_lidar * point, kAnywhere).squared_distance_m2;
  }
  return std::sqrt(sum / static_cast<double>(sets.in_lidar.size()));
}

double Nees(const Rigid3d& cam_from_lidar, const Matrix6d& covariance, const Rigid3d& truth) {
  const Vector6d difference = PoseDifference(cam_from_lidar, truth);
  const Eigen::LLT<Matrix6d> factor(covariance);
  return factor.info() == Eigen::Success ? difference.dot(factor.solve(difference)) : kNone;
}

bool IsOverconfident(const Rigid3d& cam_from_lidar, const Matrix6d& covariance,
                     const Rigid3d& truth) {
  const Vector6d error = PoseDifference(cam_from_lidar, truth);
  return IsBeyond(error.head<3>(), covariance.topLeftCorner<3, 3>()) ||
         IsBeyond(error.tail<3>(), covariance.bottomRightCorner<3, 3>());
}

}  // namespace sextant
