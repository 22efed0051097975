// SPDX-License-Identifier: Apache-2.0
#include "io/results/results_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "geometry/so3.h"

namespace sextant {
namespace {

using testing::HasSubstr;

SolveReport Report() {
  SolveReport report;
  report.solver = "kabsch";
  report.cam_from_lidar = {FromEulerZyx({.yaw = 0.1, .pitch = -0.2, .roll = 0.3}),
                           {1.0 / 3.0, -2.0, 0.0}};
  report.termination = Termination::kConverged;
  report.iterations = 3;
  report.inliers = {0, 2};
  report.covariance = Matrix6d::Identity() * 1e-5;
  report.camera =
      CameraEstimate{.camera = {.model = CameraModel::kEquidistant, .fx_px = 700.5, .fy_px = 701.0},
                     .estimated = {{"fx_px", 700.5, 1.5}, {"fy_px", 701.0, std::nullopt}}};
  report.extras = {{"range_bias_m", 0.02, 0.001}};
  report.warnings = {"board_scale was taken as given"};
  report.board_views = {{.view = 3,
                         .board = 1,
                         .used = true,
                         .printed = {1, 2},
                         .face = {300, 310},
                         .edges = {20, 21},
                         .rms = 1.125}};
  report.alternatives = {Rigid3d{}};
  report.wall_time_us = 1.25;
  report.evaluation.rmse_m = 0.04;
  report.evaluation.per_pair_m = {0.1, 0.2, 0.3};
  report.evaluation.per_pair_px = {1.5, std::numeric_limits<double>::infinity()};
  return report;
}

ResultFile TwoResults() {
  ResultFile file;
  file.version = "0.1.0";
  file.input = {.path = "points.txt", .format = "points", .pairs_3d3d = 3};
  file.results.push_back({"kabsch", Report()});
  file.results.push_back({"epnp", MakeError(ErrorCode::kMissingData, "no \"camera\"")});
  return file;
}

TEST(ResultsJson, AnUnknownTimeIsNull) {
  ResultFile file = TwoResults();
  file.results[0].report->wall_time_us = std::nan("");
  const std::string text = FormatResults(file);
  EXPECT_TRUE(nlohmann::json::parse(text)["results"][0]["wall_time_us"].is_null());
  const auto read = ParseResults(text, "result.json");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(std::isnan(read->results[0].report->wall_time_us));
}

TEST(ResultsJson, KeysAreTheContract) {
  const nlohmann::json json = nlohmann::json::parse(FormatResults(TwoResults()));
  EXPECT_EQ(json["sextant"], "0.1.0");
  EXPECT_EQ(json["input"]["path"], "points.txt");
  const auto& good = json["results"][0];
  const auto& bad = json["results"][1];
  for (const char* key :
       {"solver", "ok", "error", "error_code", "cam_from_lidar", "covariance", "camera", "extras",
        "warnings", "board_views", "rmse_m", "rmse_px", "per_pair_m", "per_pair_px", "inliers",
        "alternatives", "iterations", "termination", "wall_time_us"}) {
    EXPECT_TRUE(good.contains(key)) << key;
    EXPECT_TRUE(bad.contains(key)) << key;
  }
  EXPECT_EQ(good["ok"], true);
  EXPECT_TRUE(good["error"].is_null());
  EXPECT_EQ(good["cam_from_lidar"]["matrix"].size(), 4U);
  EXPECT_EQ(good["cam_from_lidar"]["matrix"][0][3], 1.0 / 3.0);
  EXPECT_EQ(good["cam_from_lidar"]["matrix"][3], nlohmann::json({0.0, 0.0, 0.0, 1.0}));
  EXPECT_EQ(good["cam_from_lidar"]["translation_m"][1], -2.0);
  EXPECT_EQ(good["cam_from_lidar"]["quaternion_wxyz"].size(), 4U);
  const double deg = 180.0 / 3.14159265358979323846;
  EXPECT_NEAR(good["cam_from_lidar"]["euler_zyx_deg"][0], 0.1 * deg, 1e-12);
  EXPECT_NEAR(good["cam_from_lidar"]["euler_zyx_deg"][2], 0.3 * deg, 1e-12);
  EXPECT_EQ(good["covariance"].size(), 6U);
  EXPECT_EQ(good["covariance"][5].size(), 6U);
  EXPECT_TRUE(good["rmse_px"].is_null());
  EXPECT_EQ(good["termination"], "converged");
  EXPECT_EQ(bad["ok"], false);
  EXPECT_EQ(bad["error"], "no \"camera\"");
  EXPECT_EQ(bad["error_code"], "missing_data");
  EXPECT_TRUE(bad["cam_from_lidar"].is_null());
}

TEST(ResultsJson, RoundTripsToTheBit) {
  const std::string text = FormatResults(TwoResults());
  const Expected<ResultFile> read = ParseResults(text, "r.json");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(FormatResults(*read), text);
  EXPECT_EQ(read->results[0].report->evaluation.per_pair_px[1],
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(read->results[1].report.error().code, ErrorCode::kMissingData);
}

TEST(ResultsJson, SurvivesAPathThatIsNotUtf8) {
  ResultFile file;
  file.input.path = "\xff\xfe.txt";
  EXPECT_TRUE(ParseResults(FormatResults(file), "r.json"));
}

TEST(ResultsJson, RefusesWhatIsNotAResultAndNamesTheKey) {
  std::string text = FormatResults(TwoResults());
  const auto replaced = [&text](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return changed;
  };
  const std::pair<std::string, const char*> cases[] = {
      {"", "r.json: not a sextant result file"},
      {"[1, 2]", "not a sextant result file"},
      {std::string(100'000, '['), "not a sextant result file"},
      {text.substr(0, text.size() / 2), "line"},
      {replaced("\"iterations\"", "\"iteration\""), "key 'iterations' not found"},
      {replaced("\"converged\"", "\"happy\""), "unknown value 'happy'"},
      {replaced("\"rmse_m\": 0.04", "\"rmse_m\": \"small\""), "key 'rmse_m'"},
      {replaced("\"quaternion_wxyz\": [", "\"quaternion_wxyz\": [7,"), "expected 4 numbers"},
  };
  for (const auto& [bad, message] : cases) {
    const Expected<ResultFile> read = ParseResults(bad, "r.json");
    ASSERT_FALSE(read) << message;
    EXPECT_EQ(read.error().code, ErrorCode::kParse);
    EXPECT_THAT(read.error().message, HasSubstr(message));
    EXPECT_THAT(read.error().message, testing::Not(HasSubstr("\n")));
  }
}

}  // namespace
}  // namespace sextant
