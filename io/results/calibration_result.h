// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/board.h"
#include "geometry/camera.h"
#include "geometry/lidar_pattern.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// One board in one view.
struct ResultBoardView {
  int board = 0;                              ///< Board::id.
  std::optional<Rigid3d> cam_from_board{};    ///< By the image alone.
  std::optional<Rigid3d> lidar_from_board{};  ///< By the scan alone.
  /// Of each corner under the answer; infinite where it does not project.
  std::vector<double> residuals_m{};
  std::vector<double> residuals_px{};
};

/// One moment: an image and a scan.
struct ResultView {
  int view = 0;  ///< PairId::view.
  std::string name{};
  std::string image_path{};  ///< Empty where the pairs came from elsewhere.
  std::string cloud_path{};
  std::optional<double> image_time_s{};
  std::optional<double> cloud_time_s{};
  bool kept = true;
  std::string reason{};  ///< Why it was dropped; empty where it was kept.
  std::vector<ResultBoardView> boards{};
  std::optional<double> rmse_m{};  ///< Over the view's corners, under the answer.
  std::optional<double> rmse_px{};
  std::optional<double> held_out_m{};  ///< The same under the answer of the views of other folds.
  std::optional<double> held_out_px{};
  /// What the view tells of the answer, (dphi, dt), its boards' poses eliminated.
  std::optional<Matrix6d> information{};
  /// Predicted 1 sigma of (dphi [rad], dt [m]) with this and every kept view before it.
  std::optional<Vector6d> sigma_so_far{};
};

/// How the answer moves when the views are drawn anew with replacement.
struct BootstrapFigures {
  int samples = 0;     ///< That were answered.
  int unanswered = 0;  ///< Draws from which the solver found no pose.
  double level = 0.95;
  Vector6d low = Vector6d::Zero();  ///< Of PoseDifference(drawn, answer), each axis for itself.
  Vector6d high = Vector6d::Zero();
};

/// What the views say about the answer when they are held against each other.
struct TrustFigures {
  int folds = 0;  ///< Of the cross-validation.
  std::optional<double> fit_rmse_m{};
  std::optional<double> fit_rmse_px{};
  std::optional<double> held_out_rmse_m{};
  std::optional<double> held_out_rmse_px{};
  std::optional<BootstrapFigures> bootstrap{};
  /// 1 sigma of (dphi [rad], dt [m]), three ways.
  std::optional<Vector6d> covariance_sigma{};
  std::optional<Vector6d> bootstrap_sigma{};
  std::optional<Vector6d> jackknife_sigma{};  ///< From the answers of the folds.
  /// Over the stated covariance's, as the geometric mean over the axes.
  std::optional<double> bootstrap_over_covariance{};
  std::optional<double> jackknife_over_covariance{};
  std::vector<int> outlier_views{};  ///< PairId::view.
  std::string verdict{};             ///< How the three compare, in words.
};

/// The answer of a calibration, with all that is needed to use it, to trust it and to repeat it.
struct CalibrationResult {
  std::string version{};  ///< Of the sextant that wrote it.
  std::string solver{};   ///< Canonical name.
  std::uint64_t seed = 0;
  std::vector<std::string>
      configuration;  ///< "name: value" of each setting that shapes the answer.
  std::string camera_frame = "camera";
  std::string lidar_frame = "lidar";
  Rigid3d cam_from_lidar;
  std::optional<Matrix6d> covariance{};  ///< Of (dphi [rad], dt [m]); see Perturb.
  std::optional<Camera> camera{};
  std::optional<LidarPattern> lidar{};
  std::vector<Board> boards{};
  std::vector<ResultView> views{};
  std::optional<TrustFigures> trust{};
  std::vector<std::string> warnings{};
  std::string closing{};  ///< The answer in words.
};

/// Sixteen hexadecimal digits that tell configurations apart: FNV-1a of 64 bits over the lines.
std::string ConfigurationHash(const std::vector<std::string>& configuration);

/// result.yaml and the same keys as JSON, documented in docs/formats.md. YAML leaves out what is
/// absent; JSON has it as null.
std::string FormatCalibrationResult(const CalibrationResult& result);
std::string FormatCalibrationResultJson(const CalibrationResult& result);

/// Reads either form. Errors: kIo; kParse and kNonFinite with file, line and key; an unknown key
/// names the nearest known one.
Expected<CalibrationResult> ReadCalibrationResult(const std::filesystem::path& path);
Expected<CalibrationResult> ParseCalibrationResult(std::string_view text, const std::string& file);

}  // namespace sextant
