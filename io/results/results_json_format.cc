// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "io/blocks/camera_json.h"
#include "io/blocks/pose_json.h"
#include "io/results/results_json.h"

namespace sextant {
namespace {

// Keeps the keys in the order in which they are documented.
using Json = nlohmann::ordered_json;

Json MatrixRows(const Matrix6d& matrix) {
  Json rows = Json::array();
  for (int i = 0; i < 6; ++i)
    rows.push_back(std::vector<double>(matrix.row(i).begin(), matrix.row(i).end()));
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

// Every key stands in every result, so that a tool need not ask whether it is there.
Json Result(const SolverResult& result) {
  const SolveReport* report = result.report ? &*result.report : nullptr;
  Json json;
  json["solver"] = result.solver;
  json["ok"] = report != nullptr;
  json["error"] = report ? Json(nullptr) : Json(result.report.error().message);
  json["error_code"] = report ? Json(nullptr) : Json(ToString(result.report.error().code));
  if (report == nullptr) {
    for (const char* key :
         {"cam_from_lidar", "covariance", "camera", "extras", "warnings", "board_views", "rmse_m",
          "rmse_px", "per_pair_m", "per_pair_px", "inliers", "alternatives", "iterations",
          "termination", "wall_time_us"}) {
      json[key] = nullptr;
    }
    return json;
  }
  json["cam_from_lidar"] = PoseJson(report->cam_from_lidar);
  json["covariance"] = report->covariance ? MatrixRows(*report->covariance) : Json(nullptr);
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
  json["wall_time_us"] = report->wall_time_us;
  return json;
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
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sextant
