// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text/escape.h"
#include "base/text/printable.h"
#include "io/blocks/json_blocks.h"
#include "io/results/calibration_result.h"
#include "io/text/degrees.h"
#include "io/text/json_as_yaml.h"

namespace sextant {
namespace {

// Keeps the keys in the order in which they are documented.
using Json = nlohmann::ordered_json;

Json Numbers(const Vector6d& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

Json Rows(const Matrix6d& matrix) {
  Json rows = Json::array();
  for (int i = 0; i < 6; ++i) rows.push_back(Numbers(matrix.row(i).transpose()));
  return rows;
}

Json OrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }
Json OrNull(const std::optional<Vector6d>& value) {
  return value ? Numbers(*value) : Json(nullptr);
}
Json OrNull(const std::optional<Matrix6d>& value) { return value ? Rows(*value) : Json(nullptr); }
Json OrNull(const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); }

// The pose of a board: only the translation and the quaternion.
Json OrNull(const std::optional<Rigid3d>& pose) {
  if (!pose) return nullptr;
  Json json = PoseJson(*pose);
  json.erase("matrix");
  json.erase("euler_zyx_deg");
  return json;
}

Json Residuals(const std::vector<double>& residuals) {
  Json list = Json::array();
  for (const double value : residuals) {
    list.push_back(std::isfinite(value) ? Json(value) : Json(nullptr));
  }
  return list;
}

Json LidarJson(const LidarPattern& lidar) {
  Json elevations = Json::array();
  for (const double elevation : lidar.elevations_rad) {
    elevations.push_back(ExactDegrees(elevation));
  }
  return {{"elevations_deg", std::move(elevations)},
          {"azimuth_step_deg", ExactDegrees(lidar.azimuth_step_rad)},
          {"range_sigma_m", lidar.range_sigma_m},
          {"aperture_m", lidar.aperture_m},
          {"divergence_rad", lidar.divergence_rad}};
}

Json BoardViewJson(const ResultBoardView& board) {
  return {{"board", board.board},
          {"residuals_m", Residuals(board.residuals_m)},
          {"residuals_px", Residuals(board.residuals_px)},
          {"cam_from_board", OrNull(board.cam_from_board)},
          {"lidar_from_board", OrNull(board.lidar_from_board)}};
}

Json ViewJson(const ResultView& view) {
  Json boards = Json::array();
  for (const ResultBoardView& board : view.boards) boards.push_back(BoardViewJson(board));
  return {{"view", view.view},
          {"name", OrNull(view.name)},
          {"image", OrNull(view.image_path)},
          {"cloud", OrNull(view.cloud_path)},
          {"image_time_s", OrNull(view.image_time_s)},
          {"cloud_time_s", OrNull(view.cloud_time_s)},
          {"kept", view.kept},
          {"reason", OrNull(view.reason)},
          {"rmse_m", OrNull(view.rmse_m)},
          {"rmse_px", OrNull(view.rmse_px)},
          {"held_out_m", OrNull(view.held_out_m)},
          {"held_out_px", OrNull(view.held_out_px)},
          {"sigma_so_far", OrNull(view.sigma_so_far)},
          {"information", OrNull(view.information)},
          {"boards", std::move(boards)}};
}

Json BootstrapJson(const BootstrapFigures& bootstrap) {
  return {{"samples", bootstrap.samples},
          {"unanswered", bootstrap.unanswered},
          {"level", bootstrap.level},
          {"low", Numbers(bootstrap.low)},
          {"high", Numbers(bootstrap.high)}};
}

Json TrustJson(const TrustFigures& trust) {
  return {
      {"folds", trust.folds},
      {"fit_rmse_m", OrNull(trust.fit_rmse_m)},
      {"fit_rmse_px", OrNull(trust.fit_rmse_px)},
      {"held_out_rmse_m", OrNull(trust.held_out_rmse_m)},
      {"held_out_rmse_px", OrNull(trust.held_out_rmse_px)},
      {"bootstrap", trust.bootstrap ? BootstrapJson(*trust.bootstrap) : Json(nullptr)},
      {"solver_sigma", OrNull(trust.solver_sigma)},
      {"bootstrap_sigma", OrNull(trust.bootstrap_sigma)},
      {"jackknife_sigma", OrNull(trust.jackknife_sigma)},
      {"bootstrap_over_solver", OrNull(trust.bootstrap_over_solver)},
      {"jackknife_over_solver", OrNull(trust.jackknife_over_solver)},
      {"stated_over_solver", OrNull(trust.stated_over_solver)},
      {"outlier_views", trust.outlier_views},
      {"comparison", OrNull(trust.comparison)},
  };
}

Json VerdictJson(const ResultVerdict& verdict) {
  return {{"word", ToString(verdict.usability)},
          {"reason", OrNull(verdict.reason)},
          {"next", OrNull(verdict.next)}};
}

// Every text as one line without control characters, as the reader of both forms expects it.
void MakeTextsPlain(Json& value) {
  if (value.is_string()) value = PrintableLine(value.get<std::string>());
  if (!value.is_structured()) return;
  for (Json& item : value) MakeTextsPlain(item);
}

Json ResultJson(const CalibrationResult& result) {
  Json boards = Json::array();
  for (const Board& board : result.boards) boards.push_back(BoardJson(board));
  Json views = Json::array();
  for (const ResultView& view : result.views) views.push_back(ViewJson(view));
  Json json = {{"sextant_result", 1},
               {"verdict", result.verdict ? VerdictJson(*result.verdict) : Json(nullptr)},
               {"sextant", result.version},
               {"solver", result.solver},
               {"seed", result.seed},
               {"configuration_hash", ConfigurationHash(result.configuration)},
               {"configuration", result.configuration},
               {"camera_frame", result.camera_frame},
               {"lidar_frame", result.lidar_frame},
               {"cam_from_lidar", PoseJson(result.cam_from_lidar)},
               {"covariance", OrNull(result.covariance)},
               {"closing", OrNull(result.closing)},
               {"warnings", result.warnings},
               {"trust", result.trust ? TrustJson(*result.trust) : Json(nullptr)},
               {"camera", result.camera ? CameraJson(*result.camera) : Json(nullptr)},
               {"lidar", result.lidar ? LidarJson(*result.lidar) : Json(nullptr)},
               {"boards", std::move(boards)},
               {"views", std::move(views)}};
  MakeTextsPlain(json);
  return json;
}

}  // namespace

std::string_view ToString(Usability usability) {
  switch (usability) {
    case Usability::kGood:
      return "GOOD";
    case Usability::kUsableWithCare:
      return "USABLE WITH CARE";
    case Usability::kNotUsable:
      return "NOT USABLE";
  }
  return "unknown";
}

std::string ConfigurationHash(const std::vector<std::string>& configuration) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  const auto take = [&hash](char c) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3U;
  };
  for (const std::string& line : configuration) {
    for (const char c : line) take(c);
    take('\n');
  }
  return fmt::format("{:016x}", hash);
}

std::string FormatCalibrationResult(const CalibrationResult& result) {
  return "# point_in_cam = cam_from_lidar * point_in_lidar. Metres; camera: x right, y down,\n"
         "# z forward; LiDAR: x forward, y left, z up. Covariances and sigmas are of\n"
         "# (dphi [rad], dt [m]): R = Exp(dphi) R_hat, t = t_hat + dt.\n" +
         JsonAsYaml(ResultJson(result));
}

std::string FormatCalibrationResultJson(const CalibrationResult& result) {
  return JsonText(ResultJson(result));
}

}  // namespace sextant
