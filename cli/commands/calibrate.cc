// SPDX-License-Identifier: Apache-2.0
#include "calibrate/calibrate.h"

#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/units.h"
#include "calibrate/session/session.h"
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/pose_argument.h"
#include "cli/progress.h"
#include "cli/search_options.h"
#include "io/output/output_file.h"
#include "io/output/standard_output.h"
#include "io/problems/problem_yaml.h"
#include "io/results/calibration_result.h"
#include "report/calibrate_text.h"
#include "solvers/all/all_solvers.h"

namespace sextant::cli {
namespace {

struct CalibrateCommandOptions {
  std::string session{};              ///< Session file, folder or recording; empty: files as below.
  std::vector<std::string> images{};  ///< Files, or one pattern with *.
  std::vector<std::string> clouds{};
  std::string boards_path{};  ///< Empty: the session's.
  std::string camera_path{};  ///< Empty: the session's.
  std::string camera_name{};  ///< For a simulated session with several; empty: the first.
  std::string solvers{};      ///< The first gives the result, the others are compared with it.
  std::string image_topic{};  ///< For a recording; empty: the only one.
  std::string cloud_topic{};
  double tolerance_s = 0.05;           ///< Between the stamps of an image and its scan.
  std::vector<std::string> initial{};  ///< A file, or X Y Z QW QX QY QZ; empty: along the axes.
  std::string detector{};
  std::string extractor = "rectangle";
  SearchArguments search{};
  std::vector<double> need = {10.0, 0.1};  ///< mm and degrees.
  int bootstrap = 100;                     ///< Samples; 0: neither bootstrap nor cross-validation.
  std::string out_path = "result.yaml";
  std::string json_path{};     ///< See Deliver.
  std::string problem_path{};  ///< The solvers' problem; empty: not written.
};

void DeclareSources(CalibrateCommandOptions& options, Arguments& arguments) {
  arguments.Add("SESSION", options.session,
                "Session file (YAML), folder of sextant simulate or with session.yaml, or a\n"
                "recording (.bag, .db3, .mcap); or use --image and --cloud");
  arguments.Add("--image", options.images,
                "Photos: one, several, or a quoted pattern such as 'photos/*.png'");
  arguments.Add("--cloud", options.clouds,
                "Their scans; paired by the distinguishing part of the file name: 7 in pose7.png\n"
                "and scan_007.pcd");
  arguments.Add("--image-topic", options.image_topic, "For a recording with several");
  arguments.Add("--cloud-topic", options.cloud_topic, "For a recording with several");
  arguments.Add("--tolerance", options.tolerance_s,
                "Maximum time between an image and its scan, by their stamps [s]",
                {.shows_default = true, .range = {{0.0, 3600.0}}});
  arguments.Add("--board", options.boards_path,
                "Boards (YAML, or marker_coordinates.txt); default: the session's");
  arguments.Add("--camera", options.camera_path,
                "Intrinsics; default: the session's or the recording's");
  arguments.Add("--camera-name", options.camera_name,
                "The camera to use, for a simulated session with several");
}

void Declare(CalibrateCommandOptions& options, Arguments& arguments) {
  DeclareSources(options, arguments);
  arguments.Add("--solver", options.solvers,
                "Solvers, separated by commas: the answer of the first is written, the others are\n"
                "compared with it; see sextant list solvers");
  arguments.Add("--initial", options.initial,
                "Rough cam_from_lidar, used only to choose if the views allow several: a file, or\n"
                "X Y Z QW QX QY QZ; default: a camera that looks along the LiDAR's x",
                {.min_values = 1, .max_values = 7});
  arguments.Add("--detector", options.detector, "See sextant detect");
  arguments.Add("--extractor", options.extractor, "See sextant boards", {.shows_default = true});
  DeclareSearch(options.search, arguments);
  arguments.Add(
      "--need", options.need,
      "The accuracy that you need, for the verdict: MM,DEG, 1 sigma of the least certain\n"
      "direction",
      {.shows_default = true,
       .range = {{1e-3, 1e6}},
       .min_values = 2,
       .max_values = 2,
       .separator = ','});
  arguments.Add("--bootstrap", options.bootstrap,
                "Bootstrap samples over the views; 0: neither bootstrap nor cross-validation",
                {.shows_default = true, .range = {{0, 100'000}}});
  arguments.Add("--out", options.out_path, "Result file (YAML)",
                {.shows_default = true, .writes = Writes::kFile});
  arguments.Add("--json", options.json_path, "Write the result as JSON too; - for standard output",
                {.writes = Writes::kFileOrStandardOutput});
  arguments.Add("--problem", options.problem_path,
                "Write the correspondences, for sextant solve and compare (YAML)",
                {.writes = Writes::kFile});
}

Expected<Session> ChosenSession(const CalibrateCommandOptions& options) {
  const bool has_files = !options.images.empty() || !options.clouds.empty();
  if (has_files != options.session.empty()) {
    return MakeError(ErrorCode::kInvalidOption,
                     "expected a SESSION (file, folder or recording), or --image and --cloud");
  }
  if (!has_files) return ReadSession(options.session, options.camera_name);
  if (options.images.empty() || options.clouds.empty()) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("{} is missing: expected --image and --cloud together",
                                 options.images.empty() ? "--image" : "--cloud"));
  }
  return SessionOfFiles(options.images, options.clouds);
}

// The session with what the arguments override.
Expected<Session> SessionFrom(const CalibrateCommandOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(Session session, ChosenSession(options));
  if (!options.boards_path.empty()) session.boards = options.boards_path;
  if (!options.camera_path.empty()) session.camera = options.camera_path;
  if (!options.image_topic.empty()) session.image_topic = options.image_topic;
  if (!options.cloud_topic.empty()) session.cloud_topic = options.cloud_topic;
  const bool has_boards = !session.boards.empty();
  if (!has_boards || (session.camera.empty() && session.bag.empty())) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("{} is missing: the session does not name the {}",
                    has_boards ? "--camera" : "--board", has_boards ? "camera" : "boards"));
  }
  return session;
}

Expected<std::vector<SolverPtr>> SolversFrom(const std::string& list) {
  std::vector<SolverPtr> solvers;
  if (list.empty()) return solvers;
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<SpecNode> specs, ParseSpecList(list));
  const SolverRegistry registry = AllSolvers(Commands::kAllowed);
  for (const SpecNode& spec : specs) {
    SEXTANT_ASSIGN_OR_RETURN(SolverPtr solver, registry.Make(spec));
    solvers.push_back(std::move(solver));
  }
  return solvers;
}

Expected<CalibrateOptions> SettingsFrom(const CalibrateCommandOptions& options) {
  CalibrateOptions settings{
      .observe = {.detector = options.detector, .extractor = options.extractor},
      .tolerance_s = options.tolerance_s,
      .bootstrap_samples = options.bootstrap,
      .need = {.translation_m = 1e-3 * options.need[0],
               .rotation_rad = kRadPerDeg * options.need[1]},
      .search_description = ConfigurationOf(options.search)};
  SEXTANT_ASSIGN_OR_RETURN(settings.solvers, SolversFrom(options.solvers));
  if (!options.initial.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(settings.match.initial,
                             PoseFromArgument("--initial", options.initial));
  }
  SEXTANT_ASSIGN_OR_RETURN(settings.observe.search, SearchOptionsFrom(options.search));
  return settings;
}

Expected<Calibration> CalibrateWithProgress(const CalibrateCommandOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const Session session, SessionFrom(options));
  SEXTANT_ASSIGN_OR_RETURN(CalibrateOptions settings, SettingsFrom(options));
  Progress progress;
  settings.progress = progress.Callback();
  return Calibrate(session, settings);
}

Expected<void> WriteFiles(const CalibrateCommandOptions& options, const Calibration& calibration) {
  const bool has_problem = !calibration.assembly.rows.empty();
  if (has_problem && !options.problem_path.empty()) {
    SEXTANT_RETURN_IF_ERROR(
        WriteFileAtomically(options.problem_path, FormatProblemYaml(ProblemFileOf(calibration))));
  }
  if (!calibration.result) return {};
  return WriteFileAtomically(options.out_path, FormatCalibrationResult(*calibration.result));
}

int Run(const CalibrateCommandOptions& options) {
  const Expected<Calibration> calibration = CalibrateWithProgress(options);
  if (!calibration) return Refuse("calibrate", calibration.error());
  if (Expected<void> ok = WriteFiles(options, *calibration); !ok) {
    return Refuse("calibrate", ok.error());
  }
  std::string text = DescribeCalibration(*calibration);
  if (!calibration->result) {
    Print("{}", text);
    return Refuse("calibrate", calibration->result.error(), kNoAnswer);
  }
  if (!options.out_path.empty()) {
    text += "\n" + WroteLine(options.out_path, "the result, for project, export and advise");
  }
  return Deliver(
      "calibrate", options.json_path, text, FormatCalibrationResultJson(*calibration->result),
      calibration->result->verdict->usability == Usability::kNotUsable ? kNotUsable : kAnswered);
}

}  // namespace

Command CalibrateCommand() {
  constexpr const char* kFooter =
      "The first line is the verdict: GOOD, USABLE WITH CARE or NOT USABLE, with its reason and "
      "what\n"
      "to do next. A result that is NOT USABLE is written too, with exit code 3.\n"
      "Examples:\n"
      "  sextant calibrate --image photo.png --cloud scan.pcd --board board.yaml --camera "
      "cam.yaml\n"
      "  sextant calibrate --image 'photos/*.png' --cloud 'scans/*.pcd' --board board.yaml "
      "--camera cam.yaml\n"
      "  sextant calibrate session.yaml --solver 'gnc(kabsch),kabsch,refine(ransac(p3p))'\n"
      "  sextant calibrate session.yaml --problem found.yaml && sextant compare found.yaml\n"
      "  sextant calibrate recording.bag --board board.yaml";
  return MakeCommand<CalibrateCommandOptions>(
      "calibrate", "cam_from_lidar from images and scans of boards, with its uncertainty", kFooter,
      Declare, Run);
}

}  // namespace sextant::cli
