// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <span>

#include "base/units.h"
#include "io/blocks/board_block.h"
#include "io/blocks/camera_block.h"
#include "io/results/calibration_result.h"
#include "io/results/optional_fields.h"
#include "io/text/max_id.h"
#include "io/text/number_text.h"
#include "io/text/text_file.h"
#include "io/text/yaml_fields.h"

namespace sextant {
namespace {

using Keys = std::vector<std::string>;

constexpr std::size_t kMaxNumbers = 100'000;

std::vector<double> ReadResiduals(YamlFields& in, const YamlNode& map, std::string_view key) {
  std::vector<double> residuals;
  const YamlNode* list = Present(map, key);
  if (list == nullptr || !in.IsSequence(*list, key)) return residuals;
  for (const YamlNode& node : list->items) {
    residuals.push_back(node.kind == YamlNode::Kind::kNull ? std::numeric_limits<double>::infinity()
                                                           : in.Real(node, key));
  }
  return residuals;
}

LidarPattern ReadLidar(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"elevations_deg", "azimuth_step_deg", "range_sigma_m", "aperture_m",
                             "divergence_rad"};
  LidarPattern lidar;
  if (!in.IsMap(node, "lidar", kKeys)) return lidar;
  for (const double elevation :
       in.RealList(in.Require(node, "elevations_deg"), "elevations_deg", kMaxNumbers)) {
    lidar.elevations_rad.push_back(kRadPerDeg * elevation);
  }
  lidar.azimuth_step_rad = kRadPerDeg * in.NonNegativeAt(node, "azimuth_step_deg", 0.0);
  lidar.range_sigma_m = in.NonNegativeAt(node, "range_sigma_m", 0.0);
  lidar.aperture_m = in.NonNegativeAt(node, "aperture_m", 0.0);
  lidar.divergence_rad = in.NonNegativeAt(node, "divergence_rad", 0.0);
  return lidar;
}

void ReadResultBoards(YamlFields& in, const YamlNode& list, std::vector<Board>& boards) {
  if (!in.IsSequence(list, "boards", kMaxBoards)) return;
  std::vector<const YamlNode*> nodes;
  for (const YamlNode& node : list.items) {
    nodes.push_back(&node);
    boards.push_back(ReadBoardBlock(in, node));
  }
  RequireDistinctBoards(in, nodes, boards);
}

void ReadBoardViews(YamlFields& in, const YamlNode& list, std::vector<ResultBoardView>& boards) {
  static const Keys kKeys = {"board", "residuals_m", "residuals_px", "cam_from_board",
                             "lidar_from_board"};
  if (!in.IsSequence(list, "boards")) return;
  for (const YamlNode& node : list.items) {
    if (!in.IsMap(node, "boards", kKeys)) return;
    ResultBoardView board;
    board.board = in.IntegerAt(node, "board", 0, kMaxId);
    board.residuals_m = ReadResiduals(in, node, "residuals_m");
    board.residuals_px = ReadResiduals(in, node, "residuals_px");
    board.cam_from_board = OptionalPose(in, node, "cam_from_board");
    board.lidar_from_board = OptionalPose(in, node, "lidar_from_board");
    boards.push_back(std::move(board));
  }
}

bool ReadFlag(YamlFields& in, const YamlNode& map, std::string_view key) {
  const std::string text = in.TextAt(map, key);
  if (in.ok() && text != "true" && text != "false") {
    in.Fail(map.Find(key)->line, key, fmt::format("expected true or false, got {}", Quoted(text)));
  }
  return text == "true";
}

void ReadView(YamlFields& in, const YamlNode& node, ResultView& view) {
  static const Keys kKeys = {"view",         "name",         "image",      "cloud",
                             "image_time_s", "cloud_time_s", "kept",       "reason",
                             "rmse_m",       "rmse_px",      "held_out_m", "held_out_px",
                             "sigma_so_far", "information",  "boards"};
  if (!in.IsMap(node, "views", kKeys)) return;
  view.view = in.IntegerAt(node, "view", 0, kMaxId);
  view.name = OptionalText(in, node, "name");
  view.image_path = OptionalText(in, node, "image");
  view.cloud_path = OptionalText(in, node, "cloud");
  view.image_time_s = OptionalReal(in, node, "image_time_s");
  view.cloud_time_s = OptionalReal(in, node, "cloud_time_s");
  view.kept = ReadFlag(in, node, "kept");
  view.reason = OptionalText(in, node, "reason");
  view.rmse_m = OptionalNonNegative(in, node, "rmse_m");
  view.rmse_px = OptionalNonNegative(in, node, "rmse_px");
  view.held_out_m = OptionalNonNegative(in, node, "held_out_m");
  view.held_out_px = OptionalNonNegative(in, node, "held_out_px");
  view.sigma_so_far = OptionalVector6(in, node, "sigma_so_far");
  view.information = OptionalSymmetric(in, node, "information");
  if (const YamlNode* boards = Present(node, "boards")) ReadBoardViews(in, *boards, view.boards);
}

void ReadViews(YamlFields& in, const YamlNode& list, std::vector<ResultView>& views) {
  if (!in.IsSequence(list, "views")) return;
  for (const YamlNode& node : list.items) ReadView(in, node, views.emplace_back());
}

BootstrapFigures ReadBootstrap(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"samples", "unanswered", "level", "low", "high"};
  BootstrapFigures bootstrap;
  if (!in.IsMap(node, "bootstrap", kKeys)) return bootstrap;
  bootstrap.samples = in.IntegerAt(node, "samples", 0, kMaxId);
  bootstrap.unanswered = in.IntegerAt(node, "unanswered", 0, kMaxId);
  bootstrap.level = in.RealAt(node, "level");
  bootstrap.low = ReadVector6(in, in.Require(node, "low"), "low");
  bootstrap.high = ReadVector6(in, in.Require(node, "high"), "high");
  return bootstrap;
}

std::vector<int> ReadViewNumbers(YamlFields& in, const YamlNode& map, std::string_view key) {
  std::vector<int> views;
  const YamlNode* list = Present(map, key);
  if (list == nullptr || !in.IsSequence(*list, key)) return views;
  for (const YamlNode& node : list->items) {
    const Expected<std::int64_t> number =
        ParseInteger(node.text, 0, kMaxId, {.file = in.file(), .line = node.line, .name = key});
    if (!number) in.Fail(number.error());
    views.push_back(static_cast<int>(number.value_or(0)));
  }
  return views;
}

// The key, or the one that files of version 0.1 have in its place.
std::string_view Renamed(const YamlNode& map, std::string_view key, std::string_view old_key) {
  return map.Find(key) == nullptr ? old_key : key;
}

TrustFigures ReadTrust(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"folds",
                             "fit_rmse_m",
                             "fit_rmse_px",
                             "held_out_rmse_m",
                             "held_out_rmse_px",
                             "bootstrap",
                             "solver_sigma",
                             "bootstrap_sigma",
                             "jackknife_sigma",
                             "bootstrap_over_solver",
                             "jackknife_over_solver",
                             "stated_over_solver",
                             "outlier_views",
                             "comparison",
                             "covariance_sigma",
                             "bootstrap_over_covariance",
                             "jackknife_over_covariance",
                             "verdict"};
  TrustFigures trust;
  if (!in.IsMap(node, "trust", kKeys)) return trust;
  trust.folds = in.IntegerAt(node, "folds", 0, kMaxId);
  trust.fit_rmse_m = OptionalNonNegative(in, node, "fit_rmse_m");
  trust.fit_rmse_px = OptionalNonNegative(in, node, "fit_rmse_px");
  trust.held_out_rmse_m = OptionalNonNegative(in, node, "held_out_rmse_m");
  trust.held_out_rmse_px = OptionalNonNegative(in, node, "held_out_rmse_px");
  if (const YamlNode* part = Present(node, "bootstrap")) trust.bootstrap = ReadBootstrap(in, *part);
  trust.solver_sigma = OptionalVector6(in, node, Renamed(node, "solver_sigma", "covariance_sigma"));
  trust.bootstrap_sigma = OptionalVector6(in, node, "bootstrap_sigma");
  trust.jackknife_sigma = OptionalVector6(in, node, "jackknife_sigma");
  trust.bootstrap_over_solver = OptionalNonNegative(
      in, node, Renamed(node, "bootstrap_over_solver", "bootstrap_over_covariance"));
  trust.jackknife_over_solver = OptionalNonNegative(
      in, node, Renamed(node, "jackknife_over_solver", "jackknife_over_covariance"));
  trust.stated_over_solver = OptionalNonNegative(in, node, "stated_over_solver");
  trust.outlier_views = ReadViewNumbers(in, node, "outlier_views");
  trust.comparison = OptionalText(in, node, Renamed(node, "comparison", "verdict"));
  return trust;
}

ResultVerdict ReadVerdict(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"word", "reason", "next"};
  ResultVerdict verdict;
  if (!in.IsMap(node, "verdict", kKeys)) return verdict;
  const std::string word = in.TextAt(node, "word");
  bool known = false;
  for (const Usability usability :
       {Usability::kGood, Usability::kUsableWithCare, Usability::kNotUsable}) {
    if (word != ToString(usability)) continue;
    verdict.usability = usability;
    known = true;
  }
  if (in.ok() && !known) {
    in.Fail(node.Find("word")->line, "word",
            fmt::format("expected GOOD, USABLE WITH CARE or NOT USABLE, got {}", Quoted(word)));
  }
  verdict.reason = OptionalText(in, node, "reason");
  verdict.next = OptionalText(in, node, "next");
  return verdict;
}

std::uint64_t ReadSeed(YamlFields& in, const YamlNode& root) {
  const YamlNode& node = in.Require(root, "seed");
  std::uint64_t seed = 0;
  const char* end = node.text.data() + node.text.size();
  const auto [stop, error] = std::from_chars(node.text.data(), end, seed);
  if (in.ok() && (stop != end || error != std::errc())) {
    in.Fail(node.line, "seed",
            fmt::format("expected an integer from 0 to 2^64 - 1, got {}", Quoted(node.text)));
  }
  return seed;
}

// What the file is instead of a result.
std::string DescribeOther(const YamlNode& root) {
  const auto has = [&root](std::string_view key) { return root.Find(key) != nullptr; };
  if (has("pairs") || has("images") || has("bag")) return "a session file";
  if (has("sextant_problem")) return "a problem file, for sextant solve and compare";
  if (has("sensors") || (has("boards") && has("cameras"))) return "a scene or truth file";
  if (has("boards") || has("top_right_m")) return "a board file";
  if (has("camera_matrix") || has("fx_px")) return "a file of a camera's intrinsics";
  if (root.keys.empty()) return "an empty map";
  return "a file that begins with the key " + Quoted(root.keys.front());
}

void ReadResultHeader(YamlFields& in, const YamlNode& root) {
  static const Keys kKeys = {"sextant_result", "sextant",       "solver",
                             "seed",           "configuration", "configuration_hash",
                             "camera_frame",   "lidar_frame",   "cam_from_lidar",
                             "covariance",     "closing",       "warnings",
                             "trust",          "camera",        "lidar",
                             "boards",         "views",         "verdict"};
  if (root.kind == YamlNode::Kind::kMap && root.Find("sextant_result") == nullptr) {
    in.Fail(root.line, {},
            fmt::format("expected result.yaml of sextant calibrate, or its JSON, "
                        "with the key sextant_result; this is {}",
                        DescribeOther(root)));
  }
  if (!in.IsMap(root, "sextant_result", kKeys)) return;
  in.IntegerAt(root, "sextant_result", 1, 1);
}

void ReadBody(YamlFields& in, const YamlNode& root, CalibrationResult& result) {
  if (const YamlNode* node = Present(root, "verdict")) result.verdict = ReadVerdict(in, *node);
  result.version = in.TextAt(root, "sextant");
  result.solver = in.TextAt(root, "solver");
  result.seed = ReadSeed(in, root);
  result.configuration = ReadTexts(in, root, "configuration");
  if (Present(root, "camera_frame") != nullptr) {
    result.camera_frame = in.TextAt(root, "camera_frame");
  }
  if (Present(root, "lidar_frame") != nullptr) result.lidar_frame = in.TextAt(root, "lidar_frame");
  result.cam_from_lidar = ReadPose(in, in.Require(root, "cam_from_lidar"), "cam_from_lidar");
  result.covariance = OptionalSymmetric(in, root, "covariance");
  result.closing = OptionalText(in, root, "closing");
  result.warnings = ReadTexts(in, root, "warnings");
  if (const YamlNode* node = Present(root, "trust")) result.trust = ReadTrust(in, *node);
  if (const YamlNode* node = Present(root, "camera")) result.camera = ReadCameraBlock(in, *node);
  if (const YamlNode* node = Present(root, "lidar")) result.lidar = ReadLidar(in, *node);
  if (const YamlNode* node = Present(root, "boards")) ReadResultBoards(in, *node, result.boards);
  if (const YamlNode* node = Present(root, "views")) ReadViews(in, *node, result.views);
}

}  // namespace

Expected<CalibrationResult> ReadCalibrationResult(const std::filesystem::path& path) {
  return ReadWith(path, ParseCalibrationResult);
}

Expected<CalibrationResult> ParseCalibrationResult(std::string_view text, const std::string& file) {
  // JSON is a subset of YAML.
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  YamlFields in(file);
  ReadResultHeader(in, root);
  if (!in.ok()) return in.TakeError();
  CalibrationResult result;
  ReadBody(in, root, result);
  if (!in.ok()) return in.TakeError();
  return result;
}

}  // namespace sextant
