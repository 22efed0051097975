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

/// One figure that an experiment measures.
struct Metric {
  std::string name;     ///< With its unit: "rotation_deg".
  std::string meaning;  ///< One line.
};

inline constexpr std::size_t kMaxMetrics = 64;

/// The values of one row by metric, NaN until set; those that nobody asked for need not be.
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
  CalibrationProblem inliers;  ///< With true correspondences and noise only: the bound is of these.
  std::vector<Rigid3d> cam_from_board;  ///< The truth of each of its board views.
  CalibrationProblem held_out;          ///< Other pairs, to judge an answer by; may be empty.
};

/// How far an answer is from the truth; one name, unit and definition for every experiment. The
/// indices are those of PoseMetrics().
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
  kTimeUs,  ///< Wall time: no part of an experiment's rows (eval/experiment/definition/timing.h).
  kPoseMetricCount,
};
const std::vector<Metric>& PoseMetrics();

/// When a pose counts as found, and from where on it is another pose and not noise.
struct PoseLimits {
  double success_deg = 0.5;
  double success_mm = 50.0;
  double gross_deg = 20.0;
};

/// Fills the wanted ones of PoseMetrics() but for the bound; an error instead of a report is no
/// answer. `known.problem` may hold more than the solver saw.
void MeasurePose(const KnownProblem& known, const Expected<SolveReport>& report,
                 const PoseLimits& limits, MetricValues values);

/// RMS distance [m] from each point of the LiDAR, moved by the pose, to the nearest of the camera's
/// points, whichever belongs to it. Never above the RMSE over the pairs of the same points.
double NearestNeighbourRmse(const PointSets& sets, const Rigid3d& cam_from_lidar);

/// Normalised estimation error squared: d^T C^-1 d of the difference d from the truth. Its mean is
/// 6 where the covariance C is right; NaN where C cannot be inverted.
double Nees(const Rigid3d& cam_from_lidar, const Matrix6d& covariance, const Rigid3d& truth);

}  // namespace sextant
