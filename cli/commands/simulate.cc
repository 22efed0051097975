// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <vector>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/recordings.h"
#include "io/images/image_codec.h"
#include "io/output/output_file.h"
#include "io/output/standard_output.h"
#include "io/text/text_file.h"
#include "simulator/scene/scene_file.h"
#include "simulator/session/contact_sheet.h"
#include "simulator/session/session.h"

namespace sextant::cli {
namespace {

struct SimulateOptions {
  std::string scene_path{};
  std::string out = "session";
  std::string level = "full";
  std::string pcd = "binary";
  std::string sheet_path{};  ///< Empty: none.
  std::uint64_t seed = 1;
  std::optional<std::uint64_t> unit{};  ///< None: that of the seed.
  int scans = 1;
  double interval_s = 1.0;
  bool ideal = false;
  bool bag = false;
  double lidar_sigma_m = 0.0068;
  std::optional<double> pixel_sigma_px{};  ///< None: the default of the level.
  GivenOptions given{};
};

void Declare(SimulateOptions& options, Arguments& arguments) {
  arguments.Add("SCENE", options.scene_path,
                "Scene file (YAML); experiments/scenes has a set of them");
  arguments.Add("--out", options.out,
                "Folder to write; a run that was stopped continues where it was",
                {.shows_default = true, .writes = Writes::kFolder});
  arguments.Add("--scans", options.scans, "Number of scans, with their images",
                {.shows_default = true, .range = {{1, 100'000}}});
  arguments.Add("--seed", options.seed, "The same seed gives the same bytes",
                {.shows_default = true});
  arguments.Add("--unit", options.unit,
                "Number of the LiDAR's unit, which has its own ring biases; default: the seed");
  arguments.Add("--level", options.level,
                "full: points and images; corners: as extractors find them; pairs: pixels marked\n"
                "by a person",
                {.shows_default = true});
  arguments.Add("--interval", options.interval_s, "From one scan to the next [s]",
                {.shows_default = true, .range = {{0.0, 1e6}}});
  arguments.Add("--bag", options.bag, "Write also session.bag (ROS 1), with the scans and images");
  arguments.Add("--ideal", options.ideal,
                "Sensors without noise, without blur and with a beam of no width");
  arguments.Add("--pcd", options.pcd, "ascii, binary or binary_compressed",
                {.shows_default = true});
  arguments.Add("--lidar-sigma", options.lidar_sigma_m,
                "Levels corners and pairs: LiDAR corner noise per axis [m]",
                {.shows_default = true, .range = {{0.0, 1000.0}}});
  arguments.Add("--pixel-sigma", options.pixel_sigma_px,
                "Levels corners and pairs: corner noise in the image [px]; default 1 and 3.5",
                {.range = {{0.0, 1e4}}});
  arguments.Add("--sheet", options.sheet_path,
                "Draw image, scan and edges of the first scan (.png)",
                {.writes = Writes::kCheckedByCommand});
  arguments.ReportGiven(options.given);
}

// What the level does not write, or does not draw.
Expected<void> CheckLevel(const GivenOptions& given, SessionLevel level) {
  if (level == SessionLevel::kFull) {
    return RefuseGiven(given, {"--lidar-sigma", "--pixel-sigma"},
                       "is for the levels corners and pairs; the level full has the noise of the "
                       "scene's sensors");
  }
  return RefuseGiven(given, {"--unit", "--ideal", "--pcd"},
                     "is for the level full, which alone has scans and images");
}

Expected<SessionOptions> SessionOptionsOf(const SimulateOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const SessionLevel level, FindSessionLevel(options.level));
  SEXTANT_ASSIGN_OR_RETURN(const PcdEncoding encoding, FindPcdEncoding(options.pcd));
  SEXTANT_RETURN_IF_ERROR(CheckLevel(options.given, level));
  SessionOptions session;
  session.folder = options.out;
  session.level = level;
  session.seed = options.seed;
  session.unit = options.unit;
  session.scans = options.scans;
  session.interval_s = options.interval_s;
  session.ideal = options.ideal;
  session.encoding = encoding;
  session.noise.lidar_sigma_m = options.lidar_sigma_m;
  constexpr double kMarkedByAPerson_px = 3.5;
  constexpr double kFoundInTheImage_px = 1.0;
  const bool is_marked = level == SessionLevel::kPairs;
  session.noise.pixel_sigma_px =
      options.pixel_sigma_px.value_or(is_marked ? kMarkedByAPerson_px : kFoundInTheImage_px);
  session.encode_image = [](const cv::Mat& image) { return EncodeImage(".png", image); };
  return session;
}

Expected<void> WriteSheet(const Scene& scene, const SimulateOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat sheet, DrawContactSheet(scene, options.seed));
  SEXTANT_ASSIGN_OR_RETURN(const std::string bytes, EncodeImage(".png", sheet));
  return WriteFileAtomically(options.sheet_path, bytes);
}

Expected<void> WriteExtras(const Scene& scene, const std::vector<ScanTruth>& scans,
                           const SimulateOptions& options) {
  if (options.bag) {
    if (Expected<void> ok = WriteSessionBag(options.out, scene, scans); !ok) return ok;
  }
  return options.sheet_path.empty() ? Expected<void>() : WriteSheet(scene, options);
}

// --sheet may name a file in the folder of --out, which the simulation creates; `session/` is
// `session`.
Expected<void> CheckSheet(const SimulateOptions& options) {
  const auto with_slash = [](const std::filesystem::path& folder) {
    return (folder / "").lexically_normal();
  };
  const std::filesystem::path sheet(options.sheet_path);
  if (sheet.empty() || with_slash(sheet.parent_path()) == with_slash(options.out)) return {};
  return ClaimOutput(sheet);
}

// Errors of the scene begin with its file; those of what is written name the output.
Error WithScene(const Error& error, const std::string& scene_path) {
  const bool is_of_output = error.code == ErrorCode::kIo || error.code == ErrorCode::kUnwritable ||
                            error.code == ErrorCode::kInvalidOption;
  return {error.code, is_of_output ? error.message : scene_path + ": " + error.message};
}

int Run(const SimulateOptions& options) {
  if (options.scene_path.empty()) {
    return Refuse("simulate", {ErrorCode::kInvalidOption,
                               "expected a scene file, or the subcommand pairs; scenes are in "
                               "experiments/scenes"});
  }
  const Expected<std::string> text = ReadTextFile(options.scene_path);
  if (!text) return Refuse("simulate", text.error());
  const Expected<Scene> scene = ParseScene(*text, options.scene_path);
  if (!scene) return Refuse("simulate", scene.error());
  Expected<SessionOptions> session = SessionOptionsOf(options);
  if (!session) return Refuse("simulate", session.error());
  Expected<void> checked = CheckSheet(options);
  if (checked && options.bag) checked = CheckSessionBag(*session);
  if (!checked) return Refuse("simulate", checked.error());
  Progress progress;
  ProgressCounter counter(progress.Callback(), "simulating",
                          static_cast<std::size_t>(CountSessionFiles(*scene, *session)));
  session->step = [&counter] { counter.Step(); };
  const Expected<SessionReport> report = SimulateSession(*scene, *text, *session);
  counter.Finish();
  if (!report) {
    return Refuse("simulate", WithScene(report.error(), options.scene_path));
  }
  const Expected<void> extras = WriteExtras(*scene, report->scans, options);
  Print("{}",
        WroteLine(
            options.out,
            fmt::format("scene {}, scans: {}, files written: {}, kept: {}{}; the truth is "
                        "in truth.yaml{}",
                        scene->name, options.scans, report->written, report->kept,
                        report->removed > 0
                            ? fmt::format(", removed: {} of more scans", report->removed)
                            : "",
                        options.bag && extras ? ", scans and images also in session.bag" : "")));
  return extras ? kAnswered : Refuse("simulate", extras.error());
}

}  // namespace

Command SimulateCommand() {
  constexpr const char* kFooter =
      "Examples:\n"
      "  sextant simulate experiments/scenes/paper_two_boards.yaml --out session --scans 5\n"
      "  sextant simulate pairs --views 5 --seed 7 --out session.yaml";
  Command command = MakeCommand<SimulateOptions>(
      "simulate", "Scans and images of a scene, with their truth", kFooter, Declare, Run);
  command.subcommands = {SimulatePairsCommand()};
  return command;
}

}  // namespace sextant::cli
