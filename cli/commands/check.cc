// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/units.h"
#include "base/version.h"
#include "calibrate/calibrate.h"
#include "calibrate/scene/pose_check.h"
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/scene_input.h"
#include "io/output/appended_file.h"
#include "io/results/check_result.h"
#include "io/text/number_text.h"
#include "report/collect/utc_text.h"

namespace sextant::cli {
namespace {

constexpr int kMovedExit = 3;
constexpr int kUnknownExit = 5;

struct CheckOptions {
  SceneInputOptions input{};
  std::string boards_path{};
  std::vector<double> limits = {80.0, 0.5};  ///< mm and degrees.
  std::string json_path{};
  std::string history_path{};
};

void Declare(CheckOptions& options, Arguments& arguments) {
  DeclareSceneInput(options.input, arguments);
  arguments.Add(
      "--board", options.boards_path,
      "A board is in view: the pose is compared with the calibration by it, which is more\n"
      "accurate");
  arguments.Add("--detect", options.limits,
                "MM,DEG: valid only if a change of this size would have been seen; a certain\n"
                "change that is smaller is stated, but still valid",
                {.shows_default = true,
                 .range = {{1e-3, 1e6}},
                 .min_values = 2,
                 .max_values = 2,
                 .separator = ','});
  arguments.Add("--json", options.json_path,
                "Write the check as JSON, for sextant report, too; - for standard output",
                {.writes = Writes::kFileOrStandardOutput});
  arguments.Add("--history", options.history_path,
                "Append a line to this CSV file, for checks at regular times",
                {.writes = Writes::kCheckedByCommand});
}

CheckLimits LimitsOf(const CheckOptions& options) {
  return {.rotation_rad = kRadPerDeg * options.limits[1],
          .translation_m = 1e-3 * options.limits[0]};
}

Expected<PoseCheck> CheckByBoard(const CheckOptions& options, const SceneInput& input,
                                 const ProgressCallback& progress) {
  Session session = input.session;
  session.boards = options.boards_path;
  session.camera = options.input.camera_path;
  // A change is judged by its own covariance, not by the accuracy that a calibration has to have.
  const CheckLimits limits = LimitsOf(options);
  CalibrateOptions settings{
      .camera = input.given.camera,
      .need = {.translation_m = limits.translation_m, .rotation_rad = limits.rotation_rad},
      .progress = progress};
  settings.match.initial = input.given.cam_from_lidar;
  SEXTANT_ASSIGN_OR_RETURN(const Calibration calibration, Calibrate(session, settings));
  if (!calibration.result) return PoseCheck{.reason = calibration.result.error().message};
  const CalibrationResult& result = *calibration.result;
  if (!result.covariance || result.verdict->usability == Usability::kNotUsable) {
    return PoseCheck{.reason =
                         "the calibration by the board is not usable: " + result.verdict->reason};
  }
  const auto views = std::ranges::count_if(result.views, &ResultView::kept);
  return JudgeChange(PoseDifference(result.cam_from_lidar, input.given.cam_from_lidar),
                     *result.covariance, limits, static_cast<int>(views), "views of the board");
}

Expected<PoseCheck> CheckPose(const CheckOptions& options, const SceneInput& input) {
  Progress progress;
  if (!options.boards_path.empty()) return CheckByBoard(options, input, progress.Callback());
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<ScenePair> pairs,
                           ReadScenePairs(input, progress.Callback()));
  const Rigid3d& given = input.given.cam_from_lidar;
  return CheckScenes(SearchScenes(pairs, given, progress.Callback()), given, LimitsOf(options));
}

std::string JsonOf(const PoseCheck& check, const SceneInput& input, const CheckOptions& options) {
  const CheckLimits limits = LimitsOf(options);
  CheckResult result{.version = std::string(Version()),
                     .pose_path = options.input.pose_path,
                     .read_as = std::string(ToString(input.direction)),
                     .read_by = input.direction_basis,
                     .state = std::string(ToString(check.state)),
                     .is_certain = check.is_certain,
                     .reason = check.reason,
                     .cam_from_lidar = input.given.cam_from_lidar,
                     .camera = input.given.camera,
                     .change = check.change,
                     .detect_rad = limits.rotation_rad,
                     .detect_m = limits.translation_m};
  for (const FilePair& pair : input.session.files.pairs) {
    result.pairs.push_back({pair.name, pair.image.string(), pair.cloud.string()});
  }
  const Vector6d sigma = check.covariance.diagonal().cwiseSqrt();
  if (sigma.allFinite() && sigma.minCoeff() > 0.0) result.sigma = sigma;
  return FormatCheckResult(result);
}

Expected<void> AppendHistory(const std::string& path, const PoseCheck& check,
                             const SceneInput& input) {
  if (path.empty()) return {};
  const std::string header =
      "time_utc,state,pose_read_as,pairs,change_is_certain,x_deg,y_deg,z_deg,x_mm,y_mm,z_mm,"
      "sigma_x_deg,sigma_y_deg,sigma_z_deg,sigma_x_mm,sigma_y_mm,sigma_z_mm\n";
  SEXTANT_ASSIGN_OR_RETURN(AppendedFile file, AppendedFile::Open(path));
  SEXTANT_ASSIGN_OR_RETURN(const std::string begin, file.ReadBeginning(header.size()));
  SEXTANT_ASSIGN_OR_RETURN(const std::string end, file.ReadEnd(1));
  if (!begin.empty() && begin != header) {
    return MakeError(ErrorCode::kInvalidOption,
                     path + ": is no history of sextant check; expected one, or a new file");
  }
  // An earlier line that was cut stays a line of its own.
  std::string line = begin.empty() ? header : std::string(end == "\n" ? "" : "\n");
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  line += fmt::format("{},{},{},{},{}", UtcIsoText(now), ToString(check.state),
                      ToString(input.direction), input.session.files.pairs.size(),
                      check.is_certain ? "yes" : "no");
  for (const double v : InDegreesAndMm(check.change)) line += fmt::format(",{:.4f}", v);
  for (const double v : InDegreesAndMm(check.covariance.diagonal().cwiseSqrt())) {
    line += fmt::format(",{:.4f}", v);
  }
  SEXTANT_RETURN_IF_ERROR(file.Append(line + "\n"));
  return file.Flush();
}

int Run(const CheckOptions& options) {
  if (!options.history_path.empty()) {
    const Expected<void> ok = AppendedFile::Claim(options.history_path);
    if (!ok) return Refuse("check", {ok.error().code, "--history: " + ok.error().message});
  }
  const Expected<SceneInput> input = ReadSceneInput(options.input);
  if (!input) return Refuse("check", input.error());
  const Expected<PoseCheck> check = CheckPose(options, *input);
  if (!check) return Refuse("check", check.error());
  const Expected<void> noted = AppendHistory(options.history_path, *check, *input);
  const int code = check->state == PoseState::kValid   ? kAnswered
                   : check->state == PoseState::kMoved ? kMovedExit
                                                       : kUnknownExit;
  const std::string text = fmt::format("{}: {}. The pose was read as {}.\n", ToString(check->state),
                                       check->reason, ToString(input->direction));
  const int delivered =
      Deliver("check", options.json_path, text, JsonOf(*check, *input, options), code);
  return noted ? delivered : Refuse("check", noted.error());
}

}  // namespace

Command CheckCommand() {
  constexpr const char* kFooter =
      "Depth edges of the scans are compared with the edges of the photos; no board is needed. "
      "The\n"
      "start may be off by 2 deg and 10 cm. Take pairs of scenes that differ, with objects near "
      "and far.\n"
      "Exit codes: 0 still valid, 3 moved, 5 cannot tell. docs/check.md has what limits it.\n"
      "Examples:\n"
      "  sextant check result.yaml --image 'cam/*.png' --cloud 'scan/*.pcd'\n"
      "  sextant check calib.txt:P2 --camera calib.txt:P2 --image a.png --cloud a.bin --history "
      "log.csv";
  return MakeCommand<CheckOptions>("check",
                                   "Whether a calibration is still valid, by everyday "
                                   "scenes or a board",
                                   kFooter, Declare, Run);
}

}  // namespace sextant::cli
