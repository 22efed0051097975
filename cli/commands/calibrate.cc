// SPDX-License-Identifier: Apache-2.0
#include "calibrate/calibrate.h"

#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <vector>

#include "calibrate/rig/calibrate_rig.h"
#include "calibrate/rig/observe_rig.h"
#include "calibrate/session/rig_session.h"
#include "calibrate/session/session.h"
#include "cli/calibrate_arguments.h"
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/pose_argument.h"
#include "cli/progress.h"
#include "cli/report_file.h"
#include "cli/rig_output.h"
#include "io/boards/board_file.h"
#include "io/output/output_file.h"
#include "io/output/output_target.h"
#include "io/problems/problem_yaml.h"
#include "io/results/calibration_result.h"
#include "report/calibrate_text.h"

namespace sextant::cli {
namespace {

struct CalibrateCommandOptions {
  std::string session{};              ///< Session file, folder or recording; empty: files as below.
  std::vector<std::string> images{};  ///< Files, or one pattern with *.
  std::vector<std::string> clouds{};
  std::string boards_path{};  ///< Empty: the session's.
  std::string camera_path{};  ///< Empty: the session's.
  std::string camera_name{};  ///< For a simulated session with several; empty: all, as a rig.
  std::string image_topic{};  ///< For a recording; empty: the only one.
  std::string cloud_topic{};
  double tolerance_s = 0.05;  ///< Between the stamps of an image and its scan in a recording.
  CalibrateArguments how{};
  std::string out_path{};      ///< Empty: result.yaml, or rig.json for several sensors.
  std::string json_path{};     ///< See Deliver.
  std::string problem_path{};  ///< The solvers' problem; empty: not written.
  std::string report_path{};   ///< The report in HTML; empty: not written.
  GivenOptions given{};
};

void DeclareSources(CalibrateCommandOptions& options, Arguments& arguments) {
  arguments.Add("SESSION", options.session,
                "Session file (YAML), folder of sextant simulate or with session.yaml, or a\n"
                "recording (.bag, .db3, .mcap); or use --image and --cloud. Several cameras or\n"
                "LiDARs are solved together, see docs/rigs.md; the result is then rig.json");
  arguments.Add("--image", options.images,
                "Photos: one, several, or a quoted pattern such as 'photos/*.png'");
  arguments.Add("--cloud", options.clouds,
                "Their scans; paired by the distinguishing part of the file name: 7 in pose7.png\n"
                "and scan_007.pcd");
  arguments.Add("--image-topic", options.image_topic, "For a recording with several");
  arguments.Add("--cloud-topic", options.cloud_topic, "For a recording with several");
  arguments.Add("--tolerance", options.tolerance_s,
                "For a recording: maximum time between an image and its scan [s]",
                {.shows_default = true, .range = {{0.0, 3600.0}}});
  arguments.Add("--board", options.boards_path,
                "Boards (YAML, or marker_coordinates.txt); default: the session's");
  arguments.Add("--camera", options.camera_path,
                "Intrinsics; default: the session's or the recording's");
  arguments.Add(
      "--camera-name", options.camera_name,
      "The only camera to use, for a simulated session with several; default: all, as a rig");
}

void Declare(CalibrateCommandOptions& options, Arguments& arguments) {
  DeclareSources(options, arguments);
  DeclareCalibrate(options.how, arguments);
  arguments.Add("--out", options.out_path,
                "Result file (YAML); default: result.yaml, or rig.json for several sensors",
                {.writes = Writes::kCheckedByCommand});
  arguments.Add("--json", options.json_path, "Write the result as JSON too; - for standard output",
                {.writes = Writes::kFileOrStandardOutput});
  arguments.Add("--problem", options.problem_path,
                "Write the correspondences, for sextant solve and compare (YAML)",
                {.writes = Writes::kFile});
  arguments.Add("--report", options.report_path,
                "Write a report for people who did not run this: one file of HTML that opens\n"
                "offline. Without a pose it shows what each sensor saw",
                {.writes = Writes::kFile});
  arguments.ReportGiven(options.given);
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
  SEXTANT_RETURN_IF_ERROR(RefuseGiven(options.given, {"--camera-name"},
                                      "is for the folder of a simulated session, not for files"));
  return SessionOfFiles(options.images, options.clouds);
}

// The session with what the arguments override.
Expected<Session> SessionFrom(const CalibrateCommandOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(Session session, ChosenSession(options));
  if (!options.boards_path.empty()) session.boards = options.boards_path;
  if (!options.camera_path.empty()) session.camera = options.camera_path;
  if (!options.image_topic.empty()) session.image_topic = options.image_topic;
  if (!options.cloud_topic.empty()) session.cloud_topic = options.cloud_topic;
  if (session.bag.empty()) {
    SEXTANT_RETURN_IF_ERROR(
        RefuseGiven(options.given, {"--image-topic", "--cloud-topic", "--tolerance"},
                    "is for a recording, and this session has its images and scans in files"));
  }
  const bool has_boards = !session.boards.empty();
  if (!has_boards || (session.camera.empty() && session.bag.empty())) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("{} is missing: the session does not name the {}",
                    has_boards ? "--camera" : "--board", has_boards ? "camera" : "boards"));
  }
  return session;
}

Expected<CalibrateOptions> SettingsFrom(const CalibrateCommandOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(CalibrateOptions settings, CalibrateOptionsFrom(options.how));
  settings.tolerance_s = options.tolerance_s;
  return settings;
}

Expected<void> CheckRigOptions(const CalibrateCommandOptions& options) {
  return RefuseGiven(
      options.given,
      {"--solver", "--initial", "--need", "--bootstrap", "--camera", "--image-topic",
       "--cloud-topic", "--tolerance"},
      "is for one camera and one LiDAR, and this session has more sensors (two of them alone: by "
      "--camera-name in a simulated folder, else by --image and --cloud)");
}

Expected<ObservedRig> ObserveSensors(const CalibrateCommandOptions& options,
                                     const RigSession& session, const ProgressCallback& progress) {
  SEXTANT_RETURN_IF_ERROR(CheckRigOptions(options));
  SEXTANT_ASSIGN_OR_RETURN(const CalibrateOptions settings, SettingsFrom(options));
  ObserveRigOptions observe{.observe = settings.observe, .match = settings.match};
  if (options.boards_path.empty() && session.boards.empty()) {
    return MakeError(ErrorCode::kInvalidOption,
                     "--board is missing: the session does not name the boards");
  }
  if (!options.boards_path.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(observe.boards, ReadBoards(options.boards_path));
  }
  observe.progress = progress;
  return ObserveRig(session, observe);
}

Expected<RigResult> ResultOfSensors(const ObservedRig& observed, const ProgressCallback& progress) {
  Expected<RigResult> result = CalibrateRig(observed.rig, /*estimate_time=*/false, progress);
  for (const std::string& note : observed.notes) {
    if (!result) result.error().AddLine(note);
    if (result) result->warnings.push_back(note);
  }
  return result;
}

// The path of --out; without it the result of a rig is no result.yaml.
std::string OutPath(const CalibrateCommandOptions& options, const char* default_path) {
  return options.out_path.empty() ? default_path : options.out_path;
}

Expected<void> ClaimResult(const std::string& path) {
  const Expected<void> ok = ClaimOutput(path);
  if (ok) return {};
  return MakeError(ok.error().code, "--out: " + ok.error().message);
}

Expected<Calibration> CalibrateWithProgress(const CalibrateCommandOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const Session session, SessionFrom(options));
  SEXTANT_ASSIGN_OR_RETURN(CalibrateOptions settings, SettingsFrom(options));
  const auto calibrate = [&] {
    Progress progress;
    settings.progress = progress.Callback();
    return Calibrate(session, settings);
  };
  Expected<Calibration> calibration = calibrate();
  if (calibration && calibration->result && settings.match.initial) {
    WarnOfDirection("--initial", options.how.initial, options.how.pose_is, *settings.match.initial,
                    calibration->result->cam_from_lidar);
  }
  return calibration;
}

// The result first: where the disk is full, it is worth most. The first error; the files after it
// are written too.
Expected<void> WriteFiles(const CalibrateCommandOptions& options, const std::string& out_path,
                          const Calibration& calibration) {
  Expected<void> written;
  const auto keep_first = [&written](const Expected<void>& ok) {
    if (written) written = ok;
  };
  if (calibration.result) {
    keep_first(WriteFileAtomically(out_path, FormatCalibrationResult(*calibration.result)));
  }
  if (!calibration.assembly.rows.empty() && !options.problem_path.empty()) {
    keep_first(
        WriteFileAtomically(options.problem_path, FormatProblemYaml(ProblemFileOf(calibration))));
  }
  if (!options.report_path.empty()) {
    keep_first(WriteCalibrationReport(calibration, options.tolerance_s, options.report_path));
  }
  return written;
}

int RunOnSensors(const CalibrateCommandOptions& options, const RigSession& session) {
  const std::string path = OutPath(options, "rig.json");
  if (const auto ok = ClaimResult(path); !ok) return Refuse("calibrate", ok.error());
  Expected<void> problem;
  const auto result = [&]() -> Expected<RigResult> {
    Progress progress;
    SEXTANT_ASSIGN_OR_RETURN(const ObservedRig observed,
                             ObserveSensors(options, session, progress.Callback()));
    if (!options.problem_path.empty()) {
      problem = WriteFileAtomically(options.problem_path, FormatRigFile(observed.rig));
    }
    return ResultOfSensors(observed, progress.Callback());
  }();
  const int code = DeliverRig("calibrate", result, {path, options.json_path, options.report_path});
  return problem ? code : Refuse("calibrate", problem.error());
}

int RunOnPair(const CalibrateCommandOptions& options) {
  const std::string path = OutPath(options, "result.yaml");
  if (const auto ok = ClaimResult(path); !ok) return Refuse("calibrate", ok.error());
  const Expected<Calibration> calibration = CalibrateWithProgress(options);
  if (!calibration) return Refuse("calibrate", calibration.error());
  const Expected<void> written = WriteFiles(options, path, *calibration);
  std::string text = DescribeCalibration(*calibration);
  if (written && calibration->result) {
    text += "\n" + WroteLine(path, "the result, for project, export and advise");
  }
  if (written && !options.report_path.empty()) text += WroteLine(options.report_path, kReportWords);
  int code = kNoAnswer;
  if (calibration->result) {
    const bool usable = calibration->result->verdict->usability != Usability::kNotUsable;
    code =
        Deliver("calibrate", options.json_path, text,
                FormatCalibrationResultJson(*calibration->result), usable ? kAnswered : kNotUsable);
  } else {
    PrintBesideJson(options.json_path, text);
    code = Refuse("calibrate", calibration->result.error(), kNoAnswer);
  }
  return written ? code : Refuse("calibrate", written.error());
}

int Run(const CalibrateCommandOptions& options) {
  if (!options.session.empty() && options.camera_name.empty()) {
    const auto rig = ReadRigSession(options.session);
    if (!rig) return Refuse("calibrate", rig.error());
    if (*rig) return RunOnSensors(options, **rig);
  }
  return RunOnPair(options);
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
      "  sextant calibrate recording.bag --board board.yaml\n"
      "  sextant calibrate session.yaml --report report.html\n"
      "  sextant calibrate rig_session.yaml --out rig.json";
  return MakeCommand<CalibrateCommandOptions>(
      "calibrate", "cam_from_lidar from images and scans of boards, with its uncertainty", kFooter,
      Declare, Run);
}

}  // namespace sextant::cli
