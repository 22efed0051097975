// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/running_average.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "solvers/averaging/rotation_average.h"

namespace sextant {
namespace {

// The log prints translations with this many significant digits, rotations with eight decimals.
constexpr int kSignificantDigits = 6;
constexpr double kRotationQuantum = 1e-8;

// Nine entries, each rounded by half a quantum, change a rotation by at most 3 / sqrt(2) half
// quanta. A scan contains three of these errors (the later row's counts twice), two scans six, and
// the conversion from a matrix that is not exactly a rotation at most doubles it.
constexpr double kSameRotationRad = 2.0 * 6.0 * 2.2 * 0.5 * kRotationQuantum;

// Half a unit of the last printed digit of `value`.
double PrintError(double value) {
  if (value == 0.0) return 0.0;
  return 0.5 * std::pow(10.0, std::floor(std::log10(std::abs(value))) + 1 - kSignificantDigits);
}

Expected<void> CheckRow(const RunningAverageRow& row, std::size_t i) {
  const std::string where = fmt::format("row {} of the log", i + 1);
  if (!row.mean_translation_m.allFinite() || !row.rotation.allFinite() ||
      !std::isfinite(row.rmse_m)) {
    return MakeError(ErrorCode::kNonFinite, where + " has a NaN or infinite number");
  }
  if (row.iteration != static_cast<int>(i) + 1) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("{} is iteration {}, expected {}: single scans can only be recovered from a "
                    "log that begins at 1 and has no gaps; give one run, from its start",
                    where, row.iteration, i + 1));
  }
  constexpr double kOrthonormal = 1e-5;
  const double defect =
      (row.rotation * row.rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (defect > kOrthonormal || row.rotation.determinant() < 0.0) {
    return MakeError(ErrorCode::kInvalidInput,
                     where + " has a matrix that is not a rotation (rows not orthonormal to 1e-5)");
  }
  return {};
}

std::vector<RecoveredScan> Recover(std::span<const RunningAverageRow> rows) {
  std::vector<RecoveredScan> scans;
  Eigen::Vector3d mean_before = Eigen::Vector3d::Zero();
  Eigen::Quaterniond running_before = Eigen::Quaterniond::Identity();
  for (const RunningAverageRow& row : rows) {
    const double k = row.iteration;
    const Eigen::Vector3d& mean = row.mean_translation_m;
    const Eigen::Quaterniond running = Eigen::Quaterniond(row.rotation).normalized();
    RecoveredScan scan;
    scan.iteration = row.iteration;
    scan.repeats = row.iteration;
    scan.cam_from_lidar.translation = k * mean - (k - 1.0) * mean_before;
    scan.cam_from_lidar.rotation =
        scans.empty() ? running : RecoverOriginalRotation(running_before, running);
    for (int axis = 0; axis < 3; ++axis) {
      scan.tolerance_m[axis] =
          k * PrintError(mean[axis]) + (k - 1.0) * PrintError(mean_before[axis]);
    }
    scans.push_back(scan);
    mean_before = mean;
    running_before = running;
  }
  return scans;
}

bool AreSame(const RecoveredScan& a, const RecoveredScan& b) {
  const Eigen::Array3d apart =
      (a.cam_from_lidar.translation - b.cam_from_lidar.translation).array().abs();
  return (apart <= (a.tolerance_m + b.tolerance_m).array()).all() &&
         RotationDistance(a.cam_from_lidar.rotation, b.cam_from_lidar.rotation) <= kSameRotationRad;
}

void FindRepeats(RunningAverageAnalysis& analysis) {
  std::vector<RecoveredScan>& scans = analysis.scans;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const auto end = scans.begin() + static_cast<std::ptrdiff_t>(i);
    const auto first =
        std::find_if(scans.begin(), end, [&](const RecoveredScan& s) { return AreSame(s, *end); });
    scans[i].repeats = first->iteration;
    if (first == end) ++analysis.distinct_scans;
  }
  std::size_t most = 0;
  for (std::size_t lag = 1; lag < scans.size(); ++lag) {
    std::size_t same = 0;
    for (std::size_t i = lag; i < scans.size(); ++i) {
      if (scans[i].repeats == scans[i - lag].repeats) ++same;
    }
    const std::size_t compared = scans.size() - lag;
    if (same <= most || 2 * same <= compared) continue;
    most = same;
    analysis.period = static_cast<int>(lag);
    analysis.off_period = static_cast<int>(compared - same);
  }
}

void MeasureScatter(RunningAverageAnalysis& analysis) {
  if (analysis.distinct_scans < 2) return;
  const double n = analysis.distinct_scans;
  Vector6d sum = Vector6d::Zero();
  Vector6d squares = Vector6d::Zero();
  for (const RecoveredScan& scan : analysis.scans) {
    if (scan.repeats != scan.iteration) continue;
    const Vector6d d = PoseDifference(scan.cam_from_lidar, analysis.mean);
    sum += d;
    squares += d.cwiseAbs2();
  }
  const Vector6d variance = (squares - sum.cwiseAbs2() / n) / (n - 1.0);
  analysis.standard_deviation = variance.cwiseMax(0.0).cwiseSqrt();
  analysis.standard_error = *analysis.standard_deviation / std::sqrt(n);
}

}  // namespace

Expected<RunningAverageAnalysis> AnalyseRunningAverage(std::span<const RunningAverageRow> rows) {
  if (rows.empty()) {
    return MakeError(ErrorCode::kMissingData, "the log has no iterations to analyse");
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SEXTANT_RETURN_IF_ERROR(CheckRow(rows[i], i));
  }
  RunningAverageAnalysis analysis;
  analysis.scans = Recover(rows);
  FindRepeats(analysis);
  std::vector<Eigen::Quaterniond> rotations;
  for (const RecoveredScan& scan : analysis.scans) {
    rotations.push_back(scan.cam_from_lidar.rotation);
  }
  SEXTANT_ASSIGN_OR_RETURN(const Eigen::Quaterniond chordal, ChordalMean(rotations));
  SEXTANT_ASSIGN_OR_RETURN(const Eigen::Quaterniond quaternion_sum, QuaternionSumMean(rotations));
  analysis.mean = {chordal, rows.back().mean_translation_m};
  analysis.quaternion_sum = quaternion_sum;
  analysis.logged_rotation = Eigen::Quaterniond(rows.back().rotation).normalized();
  analysis.logged_from_mean_rad = RotationDistance(analysis.logged_rotation, chordal);
  analysis.quaternion_sum_from_mean_rad = RotationDistance(quaternion_sum, chordal);
  analysis.last_rmse_m = rows.back().rmse_m;
  MeasureScatter(analysis);
  return analysis;
}

}  // namespace sextant
