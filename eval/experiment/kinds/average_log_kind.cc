// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "base/units.h"
#include "eval/experiment/definition/parameter_set.h"
#include "eval/experiment/definition/trials.h"
#include "eval/experiment/kinds/real_data.h"
#include "eval/metrics/running_average.h"
#include "io/original/average_log.h"
#include "solvers/averaging/average.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

struct AverageLogSettings {
  std::string log{};
};

enum AverageLogMeasured : int { kXM, kYM, kZM, kFromMeanMm, kFromMeanDeg, kRepeats };

const std::vector<Metric>& AverageLogMetrics() {
  static const std::vector<Metric> metrics = {
      {"x_m", "x of the averaged translation"},
      {"y_m", "y of the averaged translation"},
      {"z_m", "z of the averaged translation"},
      {"from_mean_mm", "distance of the translation from the true mean of all scans of the log"},
      {"from_mean_deg", "angle of the rotation to the same mean"},
      {"repeats", "1 if this scan repeats an earlier one, else 0"},
  };
  return metrics;
}

const ParameterSet<AverageLogSettings>& AverageLogParameters() {
  static const ParameterSet<AverageLogSettings> set = ParameterSet<AverageLogSettings>().Text(
      "log", &AverageLogSettings::log, "path",
      "avg_values.txt of the original package, relative to the folder of the real data");
  return set;
}

class AverageLogTrials final : public Trials {
 public:
  explicit AverageLogTrials(RunningAverageAnalysis analysis) : analysis_(std::move(analysis)) {}

  const std::vector<std::string>& subjects() const override {
    static const std::vector<std::string> names = {"single scan", "true mean",
                                                   "original's running average"};
    return names;
  }

  // The log is fixed, so all trials are the same.
  void Run(const TrialId& /*id*/, TrialRows& rows) const override {
    std::vector<Rigid3d> scans;
    for (const RecoveredScan& scan : analysis_.scans) {
      scans.push_back(scan.cam_from_lidar);
      const bool repeats = scan.repeats != scan.iteration;
      Measure(scan.cam_from_lidar, repeats, rows.Add(0, scan.iteration));
      const auto mean = AveragePoses(scans, RotationAverage::kChordal);
      if (mean) Measure(*mean, repeats, rows.Add(1, scan.iteration));
      const auto running = AveragePoses(scans, RotationAverage::kOriginalRunning);
      if (running) Measure(*running, repeats, rows.Add(2, scan.iteration));
    }
  }

 private:
  void Measure(const Rigid3d& pose, bool repeats, MetricValues values) const {
    const PoseDistance off = DistanceBetween(pose, analysis_.mean);
    values.Set(kXM, pose.translation.x());
    values.Set(kYM, pose.translation.y());
    values.Set(kZM, pose.translation.z());
    values.Set(kFromMeanMm, 1e3 * off.translation_m);
    values.Set(kFromMeanDeg, kDegPerRad * off.rotation_rad);
    values.Set(kRepeats, repeats ? 1.0 : 0.0);
  }

  RunningAverageAnalysis analysis_;
};

Expected<TrialsPtr> MakeAverageLogTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(const AverageLogSettings settings,
                           AverageLogParameters().Parse(arguments.parameters));
  SEXTANT_ASSIGN_OR_RETURN(const fs::path path, RealFile(settings.log, arguments.folder));
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<RunningAverageRow> rows, ReadAverageLog(path));
  SEXTANT_ASSIGN_OR_RETURN(RunningAverageAnalysis analysis, AnalyseRunningAverage(rows));
  return std::make_shared<AverageLogTrials>(std::move(analysis));
}

}  // namespace

TrialKind AverageLogKind() {
  return {.name = "average_log",
          .summary = "the scans of a log of the original package, and their running average",
          .takes_solvers = false,
          .parameters = AverageLogParameters().Describe(),
          .metrics = AverageLogMetrics(),
          .make = MakeAverageLogTrials};
}

}  // namespace sextant
