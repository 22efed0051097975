// SPDX-License-Identifier: Apache-2.0
#include "io/results/results_json.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>

#include "base/text/escape.h"
#include "io/blocks/camera_block.h"
#include "io/blocks/json_blocks.h"
#include "io/text/json_depth.h"
#include "io/text/number_text.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

// Keeps the keys in the order in which they are documented.
using Json = nlohmann::ordered_json;

Json MatrixRows(const Matrix6d& matrix) {
  Json rows = Json::array();
  for (int i = 0; i < 6; ++i) {
    rows.push_back(std::vector<double>(matrix.row(i).begin(), matrix.row(i).end()));
  }
  return rows;
}

template <class T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json Poses(const std::vector<Rigid3d>& poses) {
  Json list = Json::array();
  for (const Rigid3d& pose : poses) list.push_back(PoseJson(pose));
  return list;
}

Json Numbers(const std::vector<EstimatedNumber>& numbers) {
  Json list = Json::array();
  for (const EstimatedNumber& number : numbers) {
    list.push_back(
        {{"name", number.name}, {"value", number.value}, {"sigma", OrNull(number.sigma)}});
  }
  return list;
}

Json NoiseJson(const SolveReport& report) {
  if (!report.noise) return nullptr;
  const NoiseEstimate& noise = *report.noise;
  return {{"sigma_m", OrNull(noise.sigma_m)}, {"sigma_px", OrNull(noise.sigma_px)},
          {"is_given", noise.is_given},       {"board_errors", ToString(noise.board_errors)},
          {"boards", noise.boards},           {"shared_sigma", noise.shared_sigma},
          {"freedom", noise.freedom}};
}

Json CameraEstimateJson(const CameraEstimate& estimate) {
  Json json = CameraJson(estimate.camera);
  json["estimated"] = Numbers(estimate.estimated);
  return json;
}

Json BoardViews(const std::vector<BoardViewFit>& fits) {
  const auto count = [](const ObservationCount& of) { return Json::array({of.used, of.of}); };
  Json list = Json::array();
  for (const BoardViewFit& fit : fits) {
    list.push_back({{"view", fit.view},
                    {"board", fit.board},
                    {"used", fit.used},
                    {"cam_from_board", PoseJson(fit.cam_from_board)},
                    {"printed", count(fit.printed)},
                    {"face", count(fit.face)},
                    {"edges", count(fit.edges)},
                    {"rms", fit.rms}});
  }
  return list;
}

// Every result has every key, so that tools need not check for their presence.
Json Result(const SolverResult& result) {
  const SolveReport* report = result.report ? &*result.report : nullptr;
  Json json;
  json["solver"] = result.solver;
  json["ok"] = report != nullptr;
  json["error"] = report ? Json(nullptr) : Json(result.report.error().message);
  json["error_code"] = report ? Json(nullptr) : Json(ToString(result.report.error().code));
  if (report == nullptr) {
    for (const char* key :
         {"cam_from_lidar", "covariance", "noise", "camera", "extras", "warnings", "board_views",
          "rmse_m", "rmse_px", "per_pair_m", "per_pair_px", "inliers", "alternatives", "iterations",
          "termination", "wall_time_us"}) {
      json[key] = nullptr;
    }
    return json;
  }
  json["cam_from_lidar"] = PoseJson(report->cam_from_lidar);
  json["covariance"] = report->covariance ? MatrixRows(*report->covariance) : Json(nullptr);
  json["noise"] = NoiseJson(*report);
  json["camera"] = report->camera ? CameraEstimateJson(*report->camera) : Json(nullptr);
  json["extras"] = Numbers(report->extras);
  json["warnings"] = report->warnings;
  json["board_views"] = BoardViews(report->board_views);
  json["rmse_m"] = OrNull(report->evaluation.rmse_m);
  json["rmse_px"] = OrNull(report->evaluation.rmse_px);
  json["per_pair_m"] = report->evaluation.per_pair_m;
  json["per_pair_px"] = report->evaluation.per_pair_px;
  json["inliers"] = report->inliers;
  json["alternatives"] = Poses(report->alternatives);
  json["iterations"] = report->iterations;
  json["termination"] = ToString(report->termination);
  json["wall_time_us"] =
      std::isnan(report->wall_time_us) ? Json(nullptr) : Json(report->wall_time_us);
  return json;
}

using ParsedJson = nlohmann::json;

// Reports a wrong value by the exception that the JSON library throws for a wrong type.
[[noreturn]] void Refuse(const std::string& message) {
  throw nlohmann::detail::other_error::create(501, message, nullptr);
}

// Adds the name of the key to the library's message for a wrong type.
template <class T>
T Get(const ParsedJson& map, const char* key) {
  static_assert(!std::is_same_v<T, int>, "the library does not check the range: GetInt does");
  const ParsedJson& value = map.at(key);
  try {
    return value.get<T>();
  } catch (const ParsedJson::type_error& error) {
    Refuse(fmt::format("key '{}': {}", key, error.what()));
  }
}

int IntOf(double number, const char* key) {
  if (!(std::abs(number) <= std::numeric_limits<int>::max()) || number != std::floor(number)) {
    Refuse(fmt::format("key '{}': expected a whole number up to {}, got {:g}", key,
                       std::numeric_limits<int>::max(), number));
  }
  return static_cast<int>(number);
}

int GetInt(const ParsedJson& map, const char* key) { return IntOf(Get<double>(map, key), key); }

std::vector<int> GetInts(const ParsedJson& map, const char* key) {
  std::vector<int> numbers;
  for (const double number : Get<std::vector<double>>(map, key)) {
    numbers.push_back(IntOf(number, key));
  }
  return numbers;
}

std::optional<double> GetOptional(const ParsedJson& map, const char* key) {
  if (map.at(key).is_null()) return std::nullopt;
  return Get<double>(map, key);
}

template <int kSize>
Eigen::Matrix<double, kSize, 1> GetVector(const ParsedJson& map, const char* key) {
  const auto values = Get<std::vector<double>>(map, key);
  if (values.size() != kSize) Refuse(fmt::format("key '{}': expected {} numbers", key, kSize));
  return Eigen::Map<const Eigen::Matrix<double, kSize, 1>>(values.data());
}

Rigid3d ParsePose(const ParsedJson& json) {
  const Eigen::Vector4d wxyz = GetVector<4>(json, "quaternion_wxyz");
  if (!(std::abs(wxyz.norm() - 1.0) < 1e-5)) {
    Refuse("key 'quaternion_wxyz': expected a quaternion of length 1");
  }
  return {Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]),
          GetVector<3>(json, "translation_m")};
}

std::optional<Matrix6d> GetCovariance(const ParsedJson& map) {
  if (map.at("covariance").is_null()) return std::nullopt;
  const auto rows = Get<std::vector<std::array<double, 6>>>(map, "covariance");
  if (rows.size() != 6) Refuse("key 'covariance': expected 6 rows");
  Matrix6d covariance;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      covariance(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    }
  }
  return covariance;
}

std::vector<double> GetResiduals(const ParsedJson& map, const char* key) {
  std::vector<double> residuals;
  for (const ParsedJson& value : Get<std::vector<ParsedJson>>(map, key)) {
    residuals.push_back(value.is_null() ? std::numeric_limits<double>::infinity()
                                        : value.get<double>());
  }
  return residuals;
}

std::vector<EstimatedNumber> ParseNumbers(const ParsedJson& list) {
  std::vector<EstimatedNumber> numbers;
  for (const ParsedJson& number : list) {
    numbers.push_back({Get<std::string>(number, "name"), Get<double>(number, "value"),
                       GetOptional(number, "sigma")});
  }
  return numbers;
}

CameraEstimate ParseCameraEstimate(const ParsedJson& json) {
  CameraEstimate estimate;
  Camera& camera = estimate.camera;
  const auto name = Get<std::string>(json, "model");
  const std::optional<CameraModel> model = CameraModelNamed(name);
  if (!model) Refuse(fmt::format("key 'model': unknown value {}", Quoted(name)));
  camera.model = *model;
  camera.width_px = GetInt(json, "width_px");
  camera.height_px = GetInt(json, "height_px");
  camera.fx_px = Get<double>(json, "fx_px");
  camera.fy_px = Get<double>(json, "fy_px");
  camera.cx_px = Get<double>(json, "cx_px");
  camera.cy_px = Get<double>(json, "cy_px");
  const auto distortion = Get<std::vector<double>>(json, "distortion");
  if (distortion.size() > camera.distortion.size()) {
    Refuse(fmt::format("key 'distortion': expected at most {} numbers", camera.distortion.size()));
  }
  std::copy(distortion.begin(), distortion.end(), camera.distortion.begin());
  camera.skew_px = json.value("skew_px", 0.0);
  camera.xi = json.value("xi", 0.0);
  camera.alpha = json.value("alpha", 0.0);
  estimate.estimated = ParseNumbers(json.at("estimated"));
  return estimate;
}

template <class Enum>
Enum GetEnum(const ParsedJson& map, const char* key, Enum last) {
  const auto name = Get<std::string>(map, key);
  for (int i = 0; i <= static_cast<int>(last); ++i) {
    if (ToString(static_cast<Enum>(i)) == name) return static_cast<Enum>(i);
  }
  Refuse(fmt::format("key '{}': unknown value {}", key, Quoted(name)));
}

NoiseEstimate ParseNoise(const ParsedJson& json) {
  return {.sigma_m = GetOptional(json, "sigma_m"),
          .sigma_px = GetOptional(json, "sigma_px"),
          .is_given = Get<bool>(json, "is_given"),
          .board_errors = GetEnum(json, "board_errors", BoardErrors::kEstimated),
          .boards = GetInt(json, "boards"),
          .shared_sigma = Get<double>(json, "shared_sigma"),
          .freedom = Get<double>(json, "freedom")};
}

ObservationCount ParseCount(const ParsedJson& map, const char* key) {
  const std::vector<int> counts = GetInts(map, key);
  if (counts.size() != 2) Refuse(fmt::format("key '{}': expected 2 numbers", key));
  return {counts[0], counts[1]};
}

std::vector<BoardViewFit> ParseBoardViews(const ParsedJson& list) {
  std::vector<BoardViewFit> fits;
  for (const ParsedJson& json : list) {
    BoardViewFit fit;
    fit.view = GetInt(json, "view");
    fit.board = GetInt(json, "board");
    fit.used = Get<bool>(json, "used");
    fit.cam_from_board = ParsePose(json.at("cam_from_board"));
    fit.printed = ParseCount(json, "printed");
    fit.face = ParseCount(json, "face");
    fit.edges = ParseCount(json, "edges");
    fit.rms = Get<double>(json, "rms");
    fits.push_back(fit);
  }
  return fits;
}

SolveReport ParseReport(const ParsedJson& json) {
  SolveReport report;
  report.solver = Get<std::string>(json, "solver");
  report.cam_from_lidar = ParsePose(json.at("cam_from_lidar"));
  report.covariance = GetCovariance(json);
  // Older files lack these keys.
  if (json.contains("noise") && !json.at("noise").is_null()) {
    report.noise = ParseNoise(json.at("noise"));
  }
  if (json.contains("camera") && !json.at("camera").is_null()) {
    report.camera = ParseCameraEstimate(json.at("camera"));
  }
  if (json.contains("extras")) report.extras = ParseNumbers(json.at("extras"));
  if (json.contains("warnings")) {
    report.warnings = Get<std::vector<std::string>>(json, "warnings");
  }
  if (json.contains("board_views")) {
    report.board_views = ParseBoardViews(json.at("board_views"));
  }
  report.evaluation.rmse_m = GetOptional(json, "rmse_m");
  report.evaluation.rmse_px = GetOptional(json, "rmse_px");
  report.evaluation.per_pair_m = GetResiduals(json, "per_pair_m");
  report.evaluation.per_pair_px = GetResiduals(json, "per_pair_px");
  report.inliers = GetInts(json, "inliers");
  for (const ParsedJson& pose : json.at("alternatives"))
    report.alternatives.push_back(ParsePose(pose));
  report.iterations = GetInt(json, "iterations");
  report.termination = GetEnum(json, "termination", Termination::kMaxIterations);
  report.wall_time_us = GetOptional(json, "wall_time_us").value_or(std::nan(""));
  return report;
}

SolverResult ParseResult(const ParsedJson& json) {
  SolverResult result{Get<std::string>(json, "solver"), SolveReport{}};
  if (Get<bool>(json, "ok")) {
    result.report = ParseReport(json);
  } else {
    result.report = MakeError(GetEnum(json, "error_code", ErrorCode::kUnwritable),
                              Get<std::string>(json, "error"));
  }
  return result;
}

ResultFile ParseFile(const ParsedJson& json) {
  ResultFile file;
  file.version = Get<std::string>(json, "sextant");
  const ParsedJson& input = json.at("input");
  file.input = {.path = Get<std::string>(input, "path"),
                .format = Get<std::string>(input, "format"),
                .pairs_3d3d = GetInt(input, "pairs_3d3d"),
                .pairs_2d3d = GetInt(input, "pairs_2d3d"),
                .points_in_cam = GetInt(input, "points_in_cam"),
                .points_in_lidar = GetInt(input, "points_in_lidar")};
  for (const ParsedJson& result : json.at("results")) file.results.push_back(ParseResult(result));
  return file;
}

}  // namespace

std::string FormatResults(const ResultFile& results) {
  const ResultInput& input = results.input;
  Json json;
  json["sextant"] = results.version;
  json["input"] = {{"path", input.path},
                   {"format", input.format},
                   {"pairs_3d3d", input.pairs_3d3d},
                   {"pairs_2d3d", input.pairs_2d3d},
                   {"points_in_cam", input.points_in_cam},
                   {"points_in_lidar", input.points_in_lidar}};
  json["results"] = Json::array();
  for (const SolverResult& result : results.results) json["results"].push_back(Result(result));
  // A path may hold bytes that are not UTF-8.
  return JsonText(json);
}

Expected<ResultFile> ReadResults(const std::filesystem::path& path) {
  return ReadWith(path, ParseResults);
}

Expected<ResultFile> ParseResults(std::string_view text, const std::string& file) {
  if (IsJsonTooDeep(text)) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: not a sextant result file: nested deeper than {} levels",
                                 ToString(Place{.file = file}), kMaxJsonDepth));
  }
  try {
    return ParseFile(ParsedJson::parse(text));
  } catch (const ParsedJson::exception& error) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: not a sextant result file: {}", ToString(Place{.file = file}),
                                 Printable(error.what(), 200)));
  }
}

}  // namespace sextant
