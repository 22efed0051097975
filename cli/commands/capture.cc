// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/text/path_text.h"
#include "base/units.h"
#include "calibrate/capture/folder_watch.h"
#include "calibrate/capture/live_session.h"
#include "calibrate/session/file_pairs.h"
#include "calibrate/trust/information.h"
#include "cli/calibrate_arguments.h"
#include "cli/capture/capture_display.h"
#include "cli/capture/page_server.h"
#include "cli/capture/stop_request.h"
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report_file.h"
#include "io/output/output_file.h"
#include "io/output/standard_output.h"
#include "report/calibrate_text.h"
#include "report/collect/live_page.h"
#include "report/page/page.h"

namespace sextant::cli {
namespace {

constexpr std::uint16_t kUsualPort = 8735;

struct CaptureOptions {
  std::string folder{};
  std::string boards_path{};    ///< Empty: found in the folder.
  std::string camera_path{};    ///< The same.
  std::string image_pattern{};  ///< Empty: every image.
  std::string cloud_pattern{};
  double tolerance_s = 0.05;  ///< Between the times in the names of a photo and its scan.
  CalibrateArguments how{};
  std::optional<int> port{};  ///< None: kUsualPort, or a free one where that is taken.
  std::string out_path = "result.yaml";
  std::string report_path = "report.html";
  std::string json_path{};  ///< See Deliver.
};

void DeclareCapture(CaptureOptions& options, Arguments& arguments) {
  arguments.Add("FOLDER", options.folder,
                "Folder into which a driver writes photos and scans, or folders of them",
                {.required = true});
  arguments.Add("--board", options.boards_path,
                "Boards (YAML, or marker_coordinates.txt); default: board.yaml or boards.yaml in\n"
                "the folder");
  arguments.Add("--camera", options.camera_path,
                "Intrinsics; default: camera.yaml or the only *_info.yaml in the folder");
  arguments.Add("--image", options.image_pattern,
                "Only photos of this name, such as 'left_*.png'; default: every image");
  arguments.Add("--cloud", options.cloud_pattern,
                "Only scans of this name, such as 'top_*.pcd'; default: every scan");
  arguments.Add("--tolerance", options.tolerance_s,
                "Maximum time between a photo and its scan, where their names are times [s]",
                {.shows_default = true, .range = {{0.0, 3600.0}}});
  DeclareCalibrate(options.how, arguments);
  arguments.Add("--port", options.port,
                "Port of the page on this machine; 0: any that is free; default: 8735",
                {.range = {{0, 65535}}});
  arguments.Add("--out", options.out_path, "Result file (YAML)",
                {.shows_default = true, .writes = Writes::kFile});
  arguments.Add("--report", options.report_path, "The report at the end (HTML)",
                {.shows_default = true, .writes = Writes::kFile});
  arguments.Add("--json", options.json_path, "Write the result as JSON too; - for standard output",
                {.writes = Writes::kFileOrStandardOutput});
}

// The file of an option or, without it, the only one in the folder that its names match.
Expected<std::filesystem::path> FileFor(const std::string& option, const std::string& path,
                                        const std::filesystem::path& folder,
                                        const std::vector<std::string>& names) {
  if (!path.empty()) return std::filesystem::path(path);
  std::string expected;
  for (const std::string& name : names) {
    expected += (expected.empty() ? "" : " or ") + name;
    const auto found = ExpandPattern(folder / name);
    std::error_code ignored;
    if (!found || !std::filesystem::exists(found->front(), ignored)) continue;
    if (found->size() == 1) return found->front();
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("{} is missing: '{}' has several files {}, so name one", option,
                                 PathText(folder), name));
  }
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("{} is missing: expected the option, or {} in '{}'", option,
                               expected, PathText(folder)));
}

Expected<LiveSession> SessionFor(const CaptureOptions& options, const ProgressCallback& progress) {
  SEXTANT_ASSIGN_OR_RETURN(CalibrateOptions settings, CalibrateOptionsFrom(options.how));
  settings.progress = progress;
  SEXTANT_ASSIGN_OR_RETURN(
      const std::filesystem::path boards,
      FileFor("--board", options.boards_path, options.folder, {"board.yaml", "boards.yaml"}));
  SEXTANT_ASSIGN_OR_RETURN(
      const std::filesystem::path camera,
      FileFor("--camera", options.camera_path, options.folder, {"camera.yaml", "*_info.yaml"}));
  return LiveSession::Make(boards, camera, settings, options.tolerance_s);
}

Expected<std::unique_ptr<PageServer>> ServerFor(const std::optional<int>& port) {
  if (port) return PageServer::Start(static_cast<std::uint16_t>(*port));
  auto server = PageServer::Start(kUsualPort);
  return server ? std::move(server) : PageServer::Start(0);
}

std::string SoFar(const Calibration& calibration, const CaptureOptions& options) {
  if (!calibration.result) return "no pose yet: " + calibration.result.error().message;
  const CalibrationResult& result = *calibration.result;
  std::string text = fmt::format("{}", ToString(result.verdict->usability));
  if (result.covariance) {
    const WeakestDirections weakest = WeakestOf(*result.covariance);
    text += fmt::format(
        "; known to {:.2g} mm and {:.2g} deg in the least certain direction, {:g} mm and {:g} deg "
        "are needed",
        1e3 * weakest.translation_sigma_m, kDegPerRad * weakest.rotation_sigma_rad,
        options.how.need[0], options.how.need[1]);
  }
  return text;
}

void PrintWarnings(const FolderFiles& files) {
  for (const std::string& warning : files.warnings) PrintError("warning: {}\n", warning);
}

/// Watches the folder, and keeps page, terminal and answer up to date.
class Capture {
 public:
  Capture(const CaptureOptions& options, FolderWatch watch, LiveSession session,
          std::unique_ptr<PageServer> server)
      : options_(options),
        watch_(std::move(watch)),
        session_(std::move(session)),
        display_(std::move(server)) {}

  // Until the accuracy is reached or a signal comes.
  void Run() {
    const StopRequest stop;
    PrintNow(fmt::format(
        "Watching '{}'. Open {} in a browser on this machine; Ctrl-C ends the capture and\n"
        "writes what is known.\n",
        PathText(options_.folder), display_.address()));
    display_.Show(Page());
    while (!stop.IsMade() && !IsReached()) {
      Look();
      stop.Wait(std::chrono::milliseconds(IsReached() ? 0 : 400));
    }
  }

  bool IsReached() const {
    return calibration_ && calibration_->result &&
           calibration_->result->verdict->usability == Usability::kGood;
  }

  void End(const std::string& state) { display_.End(Page(), state); }
  const std::optional<Calibration>& calibration() const { return calibration_; }
  /// Whether there was a photo with its scan, which may be gone.
  bool had_views() const { return had_views_; }

 private:
  void Look() {
    const Expected<FolderFiles> files = watch_.Look();
    if (!files) return display_.SetState(files.error().message);
    PrintWarnings(*files);
    const std::size_t complete = files->images.size() + files->clouds.size();
    if (complete != std::exchange(complete_, complete)) display_.SetState("Looking at new files.");
    if (!session_.Take(*files)) return display_.SetState(Waiting(*files));
    display_.SetState("Computing the answer with the new views.");
    calibration_.reset();
    had_views_ = had_views_ || session_.size() > 0;
    if (session_.size() > 0) calibration_ = session_.Solve();
    std::string news = NoteNewest();
    ReportPage page = Page();
    if (calibration_) news += fmt::format("  {}\n", SoFar(*calibration_, options_));
    if (!IsReached() && !page.next.sentences.empty()) {
      news += fmt::format("  Next: {}\n", page.next.sentences.front());
    }
    PrintNow(news);
    display_.Show(std::move(page));
  }

  void PrintNow(const std::string& text) const {
    PrintBesideJson(options_.json_path, text);
    FlushOutput();
  }

  // A line for each new view.
  std::string NoteNewest() {
    constexpr std::size_t kMaxLines = 12;
    std::string lines;
    for (const std::size_t i : session_.newest()) {
      found_.insert(found_.begin(),
                    DescribeSighting(calibration_->observed.views[i], session_.boards()));
      lines += found_.front() + "\n";
    }
    found_.resize(std::min(found_.size(), kMaxLines));
    return lines;
  }

  std::string Waiting(const FolderFiles& files) const {
    std::string text = "Waiting for the next photo and scan.";
    if (files.unsettled > 0) {
      text += fmt::format(" {} file{} still being written.", files.unsettled,
                          files.unsettled == 1 ? " is" : "s are");
    }
    const auto& alone = session_.without_partner();
    if (!alone.empty()) {
      text += fmt::format(" Without a partner: {}{}.", PathText(alone.front().filename()),
                          alone.size() == 1 ? "" : fmt::format(" and {} more", alone.size() - 1));
    }
    return text;
  }

  ReportPage Page() const {
    return CollectLivePage({.calibration = calibration_ ? &*calibration_ : nullptr,
                            .boards = session_.boards(),
                            .by_arrival = session_.ByArrival(),
                            .live = {.found = found_}});
  }

  const CaptureOptions& options_;
  FolderWatch watch_;
  LiveSession session_;
  CaptureDisplay display_;
  std::optional<Calibration> calibration_{};
  bool had_views_ = false;
  std::size_t complete_ = 0;          // Files at the last look.
  std::vector<std::string> found_{};  // The newest first.
};

// The report is written also where the result cannot be.
Expected<void> WriteCapture(const CaptureOptions& options, const Calibration& calibration) {
  Expected<void> written;
  if (calibration.result) {
    written = WriteFileAtomically(options.out_path, FormatCalibrationResult(*calibration.result));
  }
  const Expected<void> report =
      WriteCalibrationReport(calibration, options.tolerance_s, options.report_path);
  return written ? report : written;
}

int DeliverCapture(const CaptureOptions& options, const Calibration& calibration,
                   const std::string& text) {
  if (!calibration.result) {
    PrintBesideJson(options.json_path, text);
    return Refuse("capture", calibration.result.error(), kNoAnswer);
  }
  return Deliver(
      "capture", options.json_path, text, FormatCalibrationResultJson(*calibration.result),
      calibration.result->verdict->usability == Usability::kNotUsable ? kNotUsable : kAnswered);
}

int Finish(const CaptureOptions& options, Capture& capture) {
  if (!capture.calibration()) {
    capture.End("The capture has ended without a photo and a scan.");
    const std::string folder = PathText(options.folder);
    const std::string why =
        capture.had_views()
            ? fmt::format(
                  "the photos and scans that '{}' had are gone, and the answer with them; "
                  "leave them there until the capture has ended",
                  folder)
            : fmt::format(
                  "no photo and scan of one moment appeared in '{}'; files are paired by "
                  "the numbers or times in their names",
                  folder);
    return Refuse("capture", {ErrorCode::kMissingData, why}, kNoAnswer);
  }
  const Calibration& calibration = *capture.calibration();
  std::string text = "\n" + DescribeCalibration(calibration);
  const Expected<void> written = WriteCapture(options, calibration);
  if (written) {
    capture.End(fmt::format("{} The report is {}.",
                            capture.IsReached() ? "The accuracy that is needed has been reached."
                                                : "The capture was ended.",
                            PathText(options.report_path)));
    if (calibration.result) {
      text += "\n" + WroteLine(options.out_path, "the result, for project, export and advise");
    }
    text += WroteLine(options.report_path, kReportWords);
  } else {
    capture.End("The capture has ended, but could not write: " + written.error().message);
  }
  const int code = DeliverCapture(options, calibration, text);
  return written ? code : Refuse("capture", written.error());
}

// At the end, after all photos were read, it would be too late.
Expected<void> CheckOutputs(const CaptureOptions& options, const FolderWatch& watch) {
  const std::array<std::pair<const char*, const std::string*>, 3> outputs = {
      {{"--out", &options.out_path},
       {"--report", &options.report_path},
       {"--json", &options.json_path}}};
  for (const auto& [option, path] : outputs) {
    if (path->empty() || *path == "-" || !watch.WouldTake(*path)) continue;
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("{}: cannot write '{}': it is taken for a photo or a scan of '{}', which is "
                    "watched; name another file",
                    option, PathText(*path), PathText(options.folder)));
  }
  return {};
}

int RunCapture(const CaptureOptions& options) {
  FolderWatch watch(options.folder, options.image_pattern, options.cloud_pattern);
  const Expected<FolderFiles> files = watch.Look();
  if (!files) return Refuse("capture", files.error());
  PrintWarnings(*files);
  if (const Expected<void> ok = CheckOutputs(options, watch); !ok) {
    return Refuse("capture", ok.error());
  }
  Progress progress;
  Expected<LiveSession> session = SessionFor(options, progress.Callback());
  if (!session) return Refuse("capture", session.error());
  Expected<std::unique_ptr<PageServer>> server = ServerFor(options.port);
  if (!server) return Refuse("capture", server.error());
  Capture capture(options, std::move(watch), *std::move(session), *std::move(server));
  capture.Run();
  return Finish(options, capture);
}

}  // namespace

Command CaptureCommand() {
  constexpr const char* kFooter =
      "Processes each photo and scan as soon as both are written, and shows on a local page and "
      "here\n"
      "what was found, what is known so far, and where to hold the board next. It ends with the\n"
      "verdict GOOD, thus with the accuracy of --need, or by Ctrl-C, and then writes result and\n"
      "report. Started again, it goes on with the files that are there. Files are paired by the\n"
      "times or numbers in their names (photo_7.png, scan_007.pcd). The page is on 127.0.0.1 "
      "only.\n"
      "Exit codes: those of sextant calibrate.\n"
      "Examples:\n"
      "  sextant capture recording --board board.yaml --camera camera.yaml\n"
      "  sextant capture recording --image 'left_*.png' --cloud 'top_*.pcd' --need 5,0.05";
  return MakeCommand<CaptureOptions>(
      "capture", "Calibration while you record, with a page that shows where to hold the board",
      kFooter, DeclareCapture, RunCapture);
}

}  // namespace sextant::cli
