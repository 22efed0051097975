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
  std::optional<Rigid3d> cam_from_board{};    ///< From the image alone.
  std::optional<Rigid3d> lidar_from_board{};  ///< From the scan alone.
  /// Residual of each corner under the result; infinite if it does not project.
  std::vector<double> residuals_m{};
  std::vector<double> residuals_px{};
};

/// One view: an image and a scan of the same moment.
struct ResultView {
  int view = 0;  ///< PairId::view.
  std::string name{};
  std::string image_path{};  ///< Empty if the pairs have another source.
  std::string cloud_path{};
  std::optional<double> image_time_s{};
  std::optional<double> cloud_time_s{};
  bool kept = true;
  std::string reason{};  ///< Why the view was dropped; empty if it was kept.
  std::vector<ResultBoardView> boards{};
  std::optional<double> rmse_m{};  ///< Over the view's corners, under the result.
  std::optional<double> rmse_px{};
  std::optional<double> held_out_m{};  ///< The same under the result of the views of other folds.
  std::optional<double> held_out_px{};
  /// The view's information on (dphi, dt), with the poses of its boards eliminated.
  std::optional<Matrix6d> information{};
  /// Predicted 1 sigma of (dphi [rad], dt [m]) with this and every kept view before it.
  std::optional<Vector6d> sigma_so_far{};
};

/// Variation of the result over bootstrap samples of the views.
struct BootstrapFigures {
  int samples = 0;     ///< Samples with a result.
  int unanswered = 0;  ///< Samples for which the solver found no pose.
  double level = 0.95;
  /// Limits of the interval of PoseDifference(sample, result), for each axis separately.
  Vector6d low = Vector6d::Zero();
  Vector6d high = Vector6d::Zero();
};

/// Whether a result can be relied on; docs/formats.md has the rules (calibrate/trust/verdict.h).
enum class Usability { kGood, kUsableWithCare, kNotUsable };

/// "GOOD", "USABLE WITH CARE" or "NOT USABLE".
std::string_view ToString(Usability usability);

struct ResultVerdict {
  Usability usability = Usability::kNotUsable;
  std::string reason{};  ///< What decided it, in one sentence.
  std::string next{};    ///< What to do next, in one sentence.
};

/// Consistency of the views with each other: cross-validation, bootstrap and jackknife.
struct TrustFigures {
  int folds = 0;  ///< Number of folds of the cross-validation.
  std::optional<double> fit_rmse_m{};
  std::optional<double> fit_rmse_px{};
  std::optional<double> held_out_rmse_m{};
  std::optional<double> held_out_rmse_px{};
  std::optional<BootstrapFigures> bootstrap{};
  /// 1 sigma of (dphi [rad], dt [m]): by the solver's noise model, and by two checks of it. The
  /// covariance of the result is the solver's, enlarged to cover what the checks show.
  std::optional<Vector6d> solver_sigma{};
  std::optional<Vector6d> bootstrap_sigma{};
  std::optional<Vector6d> jackknife_sigma{};  ///< From the results of the folds.
  /// Ratios of the sigmas to the solver's, geometric means over the axes.
  std::optional<double> bootstrap_over_solver{};
  std::optional<double> jackknife_over_solver{};
  std::optional<double> stated_over_solver{};  ///< The ratio for the result.
  std::vector<int> outlier_views{};            ///< PairId::view.
  std::string comparison{};                    ///< Comparison of the three, in words.
};

/// The result of a calibration with everything needed to use, assess and repeat it.
struct CalibrationResult {
  std::string version{};  ///< Version of sextant that wrote it.
  std::string solver{};   ///< Canonical name.
  std::uint64_t seed = 0;
  /// "name: value" of each setting that influences the result.
  std::vector<std::string> configuration{};
  std::optional<ResultVerdict> verdict{};  ///< None in files of version 0.1.
  std::string camera_frame = "camera";
  std::string lidar_frame = "lidar";
  Rigid3d cam_from_lidar;
  std::optional<Matrix6d> covariance{};  ///< Order: dphi [rad], dt [m]; see Perturb.
  std::optional<Camera> camera{};
  std::optional<LidarPattern> lidar{};
  std::vector<Board> boards{};
  std::vector<ResultView> views{};
  std::optional<TrustFigures> trust{};
  std::vector<std::string> warnings{};
  std::string closing{};  ///< The result in words.
};

/// Hash that identifies a configuration: FNV-1a of 64 bits over the lines, sixteen hexadecimal
/// digits.
std::string ConfigurationHash(const std::vector<std::string>& configuration);

/// Formats result.yaml, and the same keys as JSON; docs/formats.md documents them. YAML omits
/// absent values; JSON has them as null.
std::string FormatCalibrationResult(const CalibrationResult& result);
std::string FormatCalibrationResultJson(const CalibrationResult& result);

/// Reads either form. Errors: kIo; kParse and kNonFinite with file, line and key; the error for an
/// unknown key suggests the most similar known one.
/// Time is linear in the file's size; memory is that of ParseYaml (io/text/yaml_node.h), which
/// reads JSON up to 2 MB, about a thousand views.
Expected<CalibrationResult> ReadCalibrationResult(const std::filesystem::path& path);
Expected<CalibrationResult> ParseCalibrationResult(std::string_view text, const std::string& file);

}  // namespace sextant
