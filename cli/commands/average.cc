// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "base/text/escape.h"
#include "base/units.h"
#include "base/version.h"
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "eval/metrics/running_average.h"
#include "eval/statistics/text_table.h"
#include "io/blocks/json_blocks.h"
#include "io/original/average_log.h"

namespace sextant::cli {
namespace {

struct AverageOptions {
  std::string log_path{};
  std::string json_path{};  ///< See Deliver.
};

void Declare(AverageOptions& options, Arguments& arguments) {
  arguments.Add("LOG", options.log_path, "avg_values.txt of the original package",
                {.required = true});
  arguments.Add("--json", options.json_path, "Write the results as JSON; - for standard output",
                {.writes = Writes::kFileOrStandardOutput});
}

Rigid3d LoggedPose(const RunningAverageAnalysis& analysis) {
  return {analysis.logged_rotation, analysis.mean.translation};
}

Rigid3d PaperPose(const RunningAverageAnalysis& analysis) {
  return {analysis.quaternion_sum, analysis.mean.translation};
}

std::string Spread(const char* name, const std::optional<Vector6d>& sigma) {
  if (!sigma) return fmt::format("{:<24}  not known: one scan only\n", name);
  const Vector6d& s = *sigma;
  return fmt::format("{:<24}  {:.4f} {:.4f} {:.4f} deg   {:.2f} {:.2f} {:.2f} mm\n", name,
                     s[0] * kDegPerRad, s[1] * kDegPerRad, s[2] * kDegPerRad, s[3] * kMmPerM,
                     s[4] * kMmPerM, s[5] * kMmPerM);
}

std::string Repeats(const RunningAverageAnalysis& analysis) {
  std::string text =
      fmt::format("{} scans, {} of them distinct", analysis.scans.size(), analysis.distinct_scans);
  if (analysis.period) {
    text += fmt::format("; the recording loops every {} scans ({} break the loop)",
                        *analysis.period, analysis.off_period);
  }
  return text + "\n";
}

std::string Text(const RunningAverageAnalysis& analysis) {
  TextTable table({"cam_from_lidar", "x [m]", "y [m]", "z [m]", "yaw [deg]", "pitch", "roll",
                   "from true mean [deg]"});
  const auto add = [&table](const char* name, const Rigid3d& pose, double from_mean_rad) {
    const EulerZyx euler = ToEulerZyx(pose.rotation);
    std::vector<std::string> cells = {name};
    for (int i = 0; i < 3; ++i) cells.push_back(Fixed(pose.translation[i], 6));
    for (const double angle : {euler.yaw, euler.pitch, euler.roll}) {
      cells.push_back(Fixed(angle * kDegPerRad, 4));
    }
    cells.push_back(Fixed(from_mean_rad * kDegPerRad, 4));
    table.AddRow(std::move(cells));
  };
  add("true mean (chordal)", analysis.mean, 0.0);
  add("the paper's formula", PaperPose(analysis), analysis.quaternion_sum_from_mean_rad);
  add("as logged", LoggedPose(analysis), analysis.logged_from_mean_rad);
  return Repeats(analysis) + "\n" + table.Plain() + "\n" +
         Spread("1 sigma of a scan", analysis.standard_deviation) +
         Spread("1 sigma of the mean", analysis.standard_error) +
         fmt::format("{:<24}  {}\n", "last RMSE in the log", LengthText(analysis.last_rmse_m)) +
         "\nThe rotation in the log is not a mean: its newest scan has the weight one half. The "
         "spread\n"
         "is over the distinct scans, about x y z and along x y z; a repeated scan adds nothing.\n";
}

nlohmann::ordered_json ListOrNull(const std::optional<Vector6d>& values) {
  if (!values) return nullptr;
  return std::vector<double>(values->begin(), values->end());
}

std::string AverageJson(const AverageOptions& options, const RunningAverageAnalysis& analysis) {
  nlohmann::ordered_json scans = nlohmann::ordered_json::array();
  for (const RecoveredScan& scan : analysis.scans) {
    scans.push_back({{"iteration", scan.iteration},
                     {"repeats", scan.repeats},
                     {"cam_from_lidar", PoseJson(scan.cam_from_lidar)}});
  }
  nlohmann::ordered_json json = {
      {"sextant", std::string(Version())},
      {"log", options.log_path},
      {"iterations", analysis.scans.size()},
      {"distinct_scans", analysis.distinct_scans},
      {"period", analysis.period ? nlohmann::ordered_json(*analysis.period) : nullptr},
      {"true_mean", PoseJson(analysis.mean)},
      {"paper_formula", PoseJson(PaperPose(analysis))},
      {"logged", PoseJson(LoggedPose(analysis))},
      {"paper_rotation_from_true_mean_deg", analysis.quaternion_sum_from_mean_rad * kDegPerRad},
      {"logged_rotation_from_true_mean_deg", analysis.logged_from_mean_rad * kDegPerRad},
      {"standard_deviation", ListOrNull(analysis.standard_deviation)},
      {"standard_error", ListOrNull(analysis.standard_error)},
      {"last_rmse_m", analysis.last_rmse_m},
      {"scans", std::move(scans)},
  };
  return JsonText(json);
}

int Run(const AverageOptions& options) {
  const Expected<std::vector<RunningAverageRow>> rows = ReadAverageLog(options.log_path);
  if (!rows) return Refuse("average", rows.error());
  const Expected<RunningAverageAnalysis> analysis = AnalyseRunningAverage(*rows);
  if (!analysis) {
    return Refuse("average",
                  {analysis.error().code, options.log_path + ": " + analysis.error().message});
  }
  return Deliver("average", options.json_path, Text(*analysis), AverageJson(options, *analysis),
                 kAnswered);
}

}  // namespace

Command AverageCommand() {
  constexpr const char* kFooter =
      "The original package renormalises its quaternion sum at every scan, so that its newest "
      "scan\n"
      "always has the weight one half. This recovers the single scans and shows their true mean.\n"
      "Example:\n  sextant average conf/avg_values.txt";
  return MakeCommand<AverageOptions>(
      "average", "The single scans and the true mean of an avg_values.txt", kFooter, Declare, Run);
}

}  // namespace sextant::cli
