// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <optional>

#include "io/results/calibration_result.h"

namespace sextant {

/// The accuracy that the result has to have: 1 sigma of the least certain direction.
struct AccuracyNeed {
  double translation_m = 0.010;
  double rotation_rad = 0.1 * std::numbers::pi / 180.0;
};

/// What the verdict rests on. A figure that could not be measured is none, and its rule is skipped
/// unless JudgeResult states otherwise.
struct VerdictFigures {
  int views_with_board = 0;       ///< Views whose photo shows a board; copies do not count.
  int views_used = 0;             ///< Those of them that the answer rests on.
  int independent_views = 0;      ///< Used views, those of a board in one place counted once.
  int views_contradicting = 0;    ///< Their scan contradicts the photo, or the other views.
  int rival_poses = 0;            ///< Other poses that explain the views as well.
  bool has_rough_pose = false;    ///< Given by the user; it chose among the rivals. Else the axes.
  double rival_margin_rad = 0.0;  ///< How much farther from it the nearest rival's rotation is.
  bool is_checked = false;        ///< The views were compared with each other.
  int outlier_views = 0;          ///< Used views that disagree with the answer of the others.
  /// 1 sigma of the least certain direction, by the covariance of the result. None: unknown.
  std::optional<double> worst_translation_m{};
  std::optional<double> worst_rotation_rad{};
  std::optional<double> spread_over_solver{};  ///< Scatter of the views over the solver's sigma.
  std::optional<double> held_out_over_fit{};   ///< Ratio of the RMS errors of the corners.
  std::optional<double> halves_off{};          ///< HalvesDisagreement, in sigmas.
  std::optional<double> corner_rms_m{};        ///< Corners by the image and by the scan.
  /// Ranges in the images over those in the scans, minus 1, with its sigma.
  std::optional<double> range_excess{};
  double range_excess_sigma = 0.0;
  /// The edge in the scans over that in the board file, minus 1, where an edge contradicts the file
  /// (ContradictsFile); the largest.
  std::optional<double> size_excess{};
  std::optional<double> normals_off_rad{};  ///< Median angle between the two sensors' normals.
  std::optional<double> print_rms_px{};     ///< Printed corners under the camera model; median.
  std::optional<double> print_over_noise{};
};

/// The verdict on a result: the worst of the rules that apply, with that rule's reason and advice;
/// of several, the first in the table of docs/formats.md ("Verdict"). Without a covariance the
/// result is NOT USABLE; with fewer than kMinViewsForGood independent views, or without a
/// comparison of the views, it is at best USABLE WITH CARE.
ResultVerdict JudgeResult(const VerdictFigures& figures, const AccuracyNeed& need = {});

/// Fewer views have no majority: a wrong one could not be singled out.
inline constexpr int kMinViewsForGood = 4;

}  // namespace sextant
