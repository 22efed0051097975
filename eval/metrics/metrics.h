// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant {

/// A quantity that an experiment measures.
struct Metric {
  std::string name;     ///< Includes the unit: "rotation_deg".
  std::string meaning;  ///< Description in one line.
};

inline constexpr std::size_t kMaxMetrics = 64;

/// The values of one row by metric, NaN until set. Metrics that are not wanted may stay NaN.
class MetricValues {
 public:
  MetricValues(std::bitset<kMaxMetrics> wanted, std::span<double> values)
      : wanted_(wanted), values_(values) {}

  bool Wants(int metric) const { return wanted_[static_cast<std::size_t>(metric)]; }
  void Set(int metric, double value) { values_[static_cast<std::size_t>(metric)] = value; }

 private:
  std::bitset<kMaxMetrics> wanted_;
  std::span<double> values_;
};

/// A problem whose truth is known.
struct KnownProblem {
  CalibrationProblem problem;  ///< What solvers see.
  Rigid3d cam_from_lidar;      ///< The truth.
  /// True correspondences with noise only; the bound is computed from these.
  CalibrationProblem inliers;
  std::vector<Rigid3d> cam_from_board;  ///< True pose of the board in each board view.
  CalibrationProblem held_out;          ///< Further pairs to evaluate the result on; may be empty.
};

/// Errors of an estimated pose, with the same name, unit and definition in every experiment. The
/// values are indices into PoseMetrics().
enum PoseMetric : int {
  kAnswered,
  kFine,
  kSuccess,
  kWrong,
  kRotationDeg,
  kTranslationMm,
  kXMm,
  kYMm,
  kZMm,
  kBoundRotationDeg,
  kBoundTranslationMm,
  kNees,
  kCovered,
  kOverconfident,
  kRmseMm,
  kNearestMm,
  kRmsePx,
  kMeanPx,
  kHeldOutMm,
  kHeldOutPx,
  kInliers,
  kEstimatedXM,
  kEstimatedYM,
  kEstimatedZM,
  kEstimatedYawDeg,
  kEstimatedPitchDeg,
  kEstimatedRollDeg,
  kTimeUs,  ///< Wall time; not part of an experiment's rows (eval/experiment/definition/timing.h).
  kPoseMetricCount,
};
const std::vector<Metric>& PoseMetrics();

/// Limits within which a pose is a success, and beyond which its error is gross and not noise.
struct PoseLimits {
  double success_deg = 0.5;
  double success_mm = 50.0;
  double gross_deg = 20.0;
};

/// Sets the wanted metrics of PoseMetrics() except the bound; a report that is an error counts as
/// not answered. `known.problem` may hold more data than the solver was given.
void MeasurePose(const KnownProblem& known, const Expected<SolveReport>& report,
                 const PoseLimits& limits, MetricValues values);

/// RMS distance [m] from each LiDAR point, transformed by the pose, to the nearest camera point,
/// ignoring the correspondences. Never larger than the RMSE over the pairs of the same points.
double NearestNeighbourRmse(const PointSets& sets, const Rigid3d& cam_from_lidar);

/// Normalised estimation error squared, d^T C^-1 d, where d is the difference from the truth. Its
/// mean is 6 if the covariance C is right; NaN if C cannot be inverted.
double Nees(const Rigid3d& cam_from_lidar, const Matrix6d& covariance, const Rigid3d& truth);

/// Whether the error of rotation or translation is over three times the root mean square that the
/// covariance states.
bool IsOverconfident(const Rigid3d& cam_from_lidar, const Matrix6d& covariance,
                     const Rigid3d& truth);

}  // namespace sextant
