// SPDX-License-Identifier: Apache-2.0
#include "calibrate/advise/advise.h"

#include <fmt/format.h>

#include <filesystem>
#include <numbers>
#include <system_error>

#include "base/units.h"
#include "calibrate/advise/advise_rig.h"
#include "calibrate/observe/photo_file.h"
#include "calibrate/trust/information.h"
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/rig_output.h"
#include "eval/metrics/bounds.h"
#include "io/output/standard_output.h"
#include "io/problems/rig_yaml.h"
#include "io/results/rig_result.h"
#include "io/text/text_file.h"
#include "report/advice_picture.h"
#include "report/calibrate_text.h"
#include "report/wrapped_text.h"
#include "simulator/lidar/lidar_model.h"

namespace sextant::cli {
namespace {

struct AdviseCommandOptions {
  std::string result_path{};
  std::string picture_path{};  ///< Empty: none.
  std::string lidar{};         ///< A model of the simulator; empty: the result's, else vlp16.
  double pixel_sigma_px = 0.3;
  int count = 1;
  GivenOptions given{};
};

void Declare(AdviseCommandOptions& options, Arguments& arguments) {
  arguments.Add(
      "RESULT", options.result_path,
      "result.yaml of sextant calibrate, its JSON, or a folder that contains result.yaml;\n"
      "or a rig file, of sextant rig or of calibrate --problem",
      {.required = true});
  arguments.Add("--picture", options.picture_path,
                "Draw the place from above and as the camera would see it (.png)",
                {.writes = Writes::kFile});
  arguments.Add("--count", options.count, "How many places, each after those before it",
                {.shows_default = true, .range = {{1, 20}}});
  arguments.Add("--lidar", options.lidar,
                "A LiDAR of sextant list lidars; default: the result's own rings, else vlp16");
  arguments.Add("--pixel-sigma", options.pixel_sigma_px, "Noise of a printed corner [px]",
                {.shows_default = true, .range = {{0.001, 100.0}}});
  arguments.ReportGiven(options.given);
}

Expected<LidarPattern> PatternNamed(const std::string& name) {
  SEXTANT_ASSIGN_OR_RETURN(const LidarModel model, FindLidarModel(name));
  LidarPattern pattern{
      .azimuth_step_rad = 2.0 * std::numbers::pi * model.column_period_s / model.turn_period_s,
      .range_sigma_m = model.range_sigma_m,
      .aperture_m = model.aperture_h_m,
      .divergence_rad = model.divergence_h_rad};
  for (const LidarRing& ring : model.rings) pattern.elevations_rad.push_back(ring.elevation_rad);
  if (!pattern.elevations_rad.empty()) return pattern;
  return MakeError(
      ErrorCode::kInvalidOption,
      fmt::format("--lidar: {} has no rings, and the prediction of a board needs rings", name));
}

Expected<SensorPair> SensorsOf(const AdviseCommandOptions& options,
                               const CalibrationResult& result) {
  if (!result.camera) {
    return MakeError(
        ErrorCode::kMissingData,
        fmt::format("{} has no camera; expected its key 'camera'", options.result_path));
  }
  SensorPair sensors{.camera = *result.camera,
                     .lidar = {},
                     .cam_from_lidar = result.cam_from_lidar,
                     .pixel_sigma_px = options.pixel_sigma_px};
  if (options.lidar.empty() && result.lidar) {
    sensors.lidar = *result.lidar;
    return sensors;
  }
  const Expected<LidarPattern> pattern =
      PatternNamed(options.lidar.empty() ? "vlp16" : options.lidar);
  if (!pattern) return tl::unexpected<Error>(pattern.error());
  sensors.lidar = *pattern;
  return sensors;
}

std::string SigmaText(const Matrix6d& covariance) {
  const RmsError rms = RmsOf(covariance);
  return fmt::format("{:.2g} mm and {:.2g} deg; weakest {}", rms.translation_m * 1e3,
                     rms.rotation_rad / kRadPerDeg, DescribeWeakest(WeakestOf(covariance)));
}

std::string NameOf(const CalibrationResult& result, int view) {
  for (const ResultView& one : result.views) {
    if (one.view == view && !one.name.empty()) return one.name;
  }
  return fmt::format("view {}", view);
}

// What the existing views determine, from the first advice.
std::string ViewsText(const CalibrationResult& result, const Advice& advice) {
  std::string text =
      fmt::format("cam_from_lidar after {}, predicted 1 sigma:\n",
                  advice.views == 1 ? "the one view" : fmt::format("the {} views", advice.views));
  for (const KnownAfter& after : advice.after) {
    text +=
        fmt::format("  after {:<12} {}\n", NameOf(result, after.view), SigmaText(after.covariance));
  }
  if (advice.after.empty()) text += "  the pose is not determined yet\n";
  for (const std::string& warning : advice.warnings) text += "  note: " + warning + "\n";
  return text;
}

// The proposal as a view of the result, so that the next proposal takes it into account.
ResultView AsView(const CalibrationResult& result, const BoardProposal& proposal) {
  ResultView view;
  view.view = -1;
  view.information = proposal.information;
  view.boards.push_back(
      {.board = result.boards[proposal.board].id, .cam_from_board = proposal.cam_from_board});
  return view;
}

// Places one after the other. `text` describes those that were found, also before an error.
Expected<std::vector<BoardProposal>> Propose(const CalibrationResult& result,
                                             const SensorPair& sensors, int count,
                                             std::string& text) {
  Progress progress;
  ProgressCounter counter(progress.Callback(), "places", static_cast<std::size_t>(count));
  CalibrationResult growing = result;
  std::vector<BoardProposal> proposals;
  for (int i = 0; i < count; ++i) {
    SEXTANT_ASSIGN_OR_RETURN(const Advice advice, Advise(growing, sensors));
    if (i == 0) text += ViewsText(result, advice);
    text += fmt::format("{}\n  {} rings would cross it; predicted 1 sigma then {}\n",
                        advice.proposal.sentence, advice.proposal.rings,
                        SigmaText(advice.proposal.covariance));
    proposals.push_back(advice.proposal);
    growing.views.push_back(AsView(growing, advice.proposal));
    counter.Step();
  }
  counter.Finish();
  return proposals;
}

Expected<void> CheckPicture(const std::string& path) {
  if (path.empty()) return {};
  return CheckImageName(path);
}

std::string RigAdviceText(const RigAdvice& advice) {
  std::string text;
  for (const std::string& warning : advice.warnings) {
    text += Wrapped("warning: " + warning, kTextWidth);
  }
  text += Wrapped(
      fmt::format("The weakest pair is {} and {}, which see {} {} together: 1 sigma {} for points "
                  "{:.1f} m away.",
                  advice.weakest.a, advice.weakest.b, advice.weakest.views,
                  advice.weakest.views == 1 ? "board" : "boards",
                  SigmaText(advice.weakest.a_from_b.covariance), advice.distance_m),
      kTextWidth);
  text += Wrapped(advice.sentence, kTextWidth);
  return text + Wrapped(fmt::format("{} would see it there; predicted 1 sigma of the pair then {}",
                                    fmt::join(advice.seen_by, ", "), SigmaText(advice.covariance)),
                        kTextWidth);
}

int AdviseOnRig(const AdviseCommandOptions& options, const std::string& text) {
  const Expected<void> ok =
      RefuseGiven(options.given, {"--picture", "--count", "--lidar", "--pixel-sigma"},
                  "is for a result of one camera and one LiDAR, and this is a rig");
  if (!ok) return Refuse("advise", ok.error());
  const Expected<RigFile> rig = ParseRigFile(text, options.result_path);
  if (!rig) return Refuse("advise", rig.error());
  const Expected<RigAdvice> advice = AdviseRig(*rig);
  if (!advice) return Refuse("advise", advice.error(), ExitCodeOfRig(advice.error()));
  Print("{}", RigAdviceText(*advice));
  return kAnswered;
}

int Run(const AdviseCommandOptions& options) {
  if (const Expected<void> ok = CheckPicture(options.picture_path); !ok) {
    return Refuse("advise", ok.error());
  }
  std::filesystem::path path = options.result_path;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) path /= "result.yaml";
  const Expected<std::string> file = ReadTextFile(path);
  const auto after_calibrate = [](const Error& error) {
    return Refuse(
        "advise",
        {error.code, fmt::format("{}; for a session, run sextant calibrate first", error.message)});
  };
  if (!file) return after_calibrate(file.error());
  if (IsRigFile(*file)) return AdviseOnRig(options, *file);
  if (IsRigResult(*file)) {
    return Refuse("advise",
                  {ErrorCode::kInvalidInput,
                   fmt::format("{} has the poses of a rig, but not what its sensors measured: give "
                               "the rig file, which sextant rig reads and calibrate --problem "
                               "writes",
                               options.result_path)});
  }
  const Expected<CalibrationResult> result = ParseCalibrationResult(*file, path.string());
  if (!result) return after_calibrate(result.error());
  const Expected<SensorPair> sensors = SensorsOf(options, *result);
  if (!sensors) return Refuse("advise", sensors.error());
  std::string text;
  const auto proposals = Propose(*result, *sensors, options.count, text);
  Print("{}{}", CautionAbout(*result), Narrow(text));
  if (!proposals) return Refuse("advise", proposals.error(), kNoAnswer);
  if (options.picture_path.empty()) return kAnswered;
  const Expected<void> written =
      WriteImage(DrawAdvice(*result, *sensors, *proposals), options.picture_path);
  if (!written) return Refuse("advise", written.error());
  Print("{}", WroteLine(options.picture_path, "the place from above and in the camera's image"));
  return kAnswered;
}

}  // namespace

Command AdviseCommand() {
  constexpr const char* kFooter =
      "The proposed place is the one of a grid, visible to both sensors, for which the predicted\n"
      "covariance is smallest (D-optimal); of a rig, for which that of the pair of sensors known\n"
      "worst is.\n"
      "Examples:\n"
      "  sextant advise result.yaml --picture next.png\n"
      "  sextant advise rig.yaml";
  return MakeCommand<AdviseCommandOptions>(
      "advise", "How well the views determine the answer, and where to hold a board next", kFooter,
      Declare, Run);
}

}  // namespace sextant::cli
