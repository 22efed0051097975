// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"
#include "geometry/running_average_row.h"

namespace sextant {

/// The pose estimated from one scan alone, recovered from two consecutive rows of the log.
struct RecoveredScan {
  int iteration = 0;
  Rigid3d cam_from_lidar;
  /// Largest error per axis due to the printed digits: the log has six significant digits of the
  /// mean, and scan k is computed from k times the mean.
  Eigen::Vector3d tolerance_m = Eigen::Vector3d::Zero();
  /// Iteration of the first scan equal to this one; its own iteration if it is new.
  int repeats = 0;
};

/// Analysis of a log of the original package.
struct RunningAverageAnalysis {
  std::vector<RecoveredScan> scans;
  int distinct_scans = 0;
  /// For a looped recording: the lag at which the most scans repeat, if more than half of them do.
  std::optional<int> period;
  int off_period = 0;  ///< Scans that differ from the one `period` before.

  Rigid3d mean;  ///< Chordal mean of the rotations and mean of the translations of all iterations.
  Eigen::Quaterniond quaternion_sum;   ///< Mean rotation of all iterations by the paper's formula.
  Eigen::Quaterniond logged_rotation;  ///< Rotation of the last row.
  double logged_from_mean_rad = 0.0;
  double quaternion_sum_from_mean_rad = 0.0;

  /// Standard deviation of a single scan in (dphi [rad], dt [m]) about the mean, and of the mean
  /// itself, computed from the distinct scans (a repeated scan adds no information). None for a
  /// single distinct scan.
  std::optional<Vector6d> standard_deviation;
  std::optional<Vector6d> standard_error;

  double last_rmse_m = 0.0;
};

/// Recovers the single scans from the running averages and computes their true mean.
///
/// Translation: t_k = k m_k - (k - 1) m_(k-1). Rotation: RecoverOriginalRotation; the first row is
/// the first scan. Two scans are equal if they differ by no more than the rounding of the printed
/// digits. Errors: kMissingData (no rows); kInvalidInput (iterations that do not count 1, 2, 3 ...,
/// a matrix that is not a rotation; names the row); kNonFinite; kDegenerate (no mean rotation).
Expected<RunningAverageAnalysis> AnalyseRunningAverage(std::span<const RunningAverageRow> rows);

}  // namespace sextant
