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

/// The answer for one scan alone, recovered from two rows of the log.
struct RecoveredScan {
  int iteration = 0;
  Rigid3d cam_from_lidar;
  /// Largest error per axis that the printed digits leave: the log has six significant digits of
  /// the mean, and the scan takes k times the mean of k.
  Eigen::Vector3d tolerance_m = Eigen::Vector3d::Zero();
  /// Iteration of the first scan that this one repeats; its own where it is new.
  int repeats = 0;
};

/// What a log of the original package really says.
struct RunningAverageAnalysis {
  std::vector<RecoveredScan> scans;
  int distinct_scans = 0;
  /// Of a looped recording: the lag at which the most scans repeat, where over half of them do.
  std::optional<int> period;
  int off_period = 0;  ///< Scans that are not the same as the one `period` before.

  Rigid3d mean;  ///< Over all iterations: chordal mean of the rotations, mean of the translations.
  Eigen::Quaterniond quaternion_sum;   ///< The paper's formula over all iterations.
  Eigen::Quaterniond logged_rotation;  ///< The last row's.
  double logged_from_mean_rad = 0.0;
  double quaternion_sum_from_mean_rad = 0.0;

  /// Of (dphi [rad], dt [m]) from the mean, over the distinct scans: one standard deviation of a
  /// scan, and of their mean (a repeated scan tells nothing new). None for a single distinct scan.
  std::optional<Vector6d> standard_deviation;
  std::optional<Vector6d> standard_error;

  double last_rmse_m = 0.0;
};

/// Recovers the single scans from the running values and averages them properly.
///
/// Translation: t_k = k m_k - (k - 1) m_(k-1). Rotation: RecoverOriginalRotation; the first row is
/// the first scan. Two scans are the same where they differ by no more than printing allows.
/// Errors: kMissingData (no rows); kInvalidInput (iterations that do not count 1, 2, 3 ..., a
/// matrix that is no rotation; names the row); kNonFinite; kDegenerate (no mean rotation).
Expected<RunningAverageAnalysis> AnalyseRunningAverage(std::span<const RunningAverageRow> rows);

}  // namespace sextant
