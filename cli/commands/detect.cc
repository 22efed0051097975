// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <filesystem>

#include "calibrate/observe/photo_file.h"
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "features/camera/grey_image.h"
#include "io/boards/board_file.h"
#include "io/cameras/camera_file.h"
#include "io/output/output_target.h"
#include "io/text/text_file.h"
#include "report/detect_report.h"

namespace sextant::cli {
namespace {

constexpr const char* kDefaultDetector = "apriltag(family=tag36h11)";

struct DetectOptions {
  std::vector<std::string> images{};
  std::string board_path{};    ///< Empty: all tags that the detector finds.
  std::string camera_path{};   ///< Empty: no poses.
  std::string detector{};      ///< Empty: the default ones for the families of the boards.
  std::string overlay_path{};  ///< Empty: none.
  std::string json_path{};     ///< See Deliver.
  bool quick = false;          ///< Do not search for the reason why a tag is missing.
};

void Declare(DetectOptions& options, Arguments& arguments) {
  arguments.Add("IMAGE", options.images, "Photos, examined in parallel", {.required = true});
  arguments.Add("--board", options.board_path,
                "The boards to find: board YAML or marker_coordinates.txt; default: all tags of\n"
                "--detector");
  arguments.Add("--camera", options.camera_path,
                "Intrinsics, for poses and corners in the camera frame", {.needs = "--board"});
  arguments.Add("--detector", options.detector,
                "aruco, apriltag or checkerboard, with options; see sextant list detectors");
  arguments.Add("--overlay", options.overlay_path,
                "Draw what was found (.png or .jpg); for several images one out-NAME.png each",
                {.writes = Writes::kCheckedByCommand});
  arguments.Add("--json", options.json_path, "Write the results as JSON; - for standard output",
                {.writes = Writes::kFileOrStandardOutput});
  arguments.Add("--quick", options.quick, "Do not search for the reason why a tag is missing");
}

// What is searched for: boards, or the tags of one detector.
struct Search {
  std::optional<BoardFinder> finder;
  TagDetectorPtr detector;
  bool explain = true;

  std::vector<Board> Boards() const { return finder ? finder->boards() : std::vector<Board>(); }
  std::optional<Camera> GetCamera() const {
    return finder ? finder->camera() : std::optional<Camera>();
  }
};

Expected<Search> MakeSearch(const DetectOptions& options) {
  Search search{.finder = {}, .detector = {}, .explain = !options.quick};
  if (options.board_path.empty()) {
    Expected<TagDetectorPtr> detector =
        MakeTagDetector(options.detector.empty() ? kDefaultDetector : options.detector);
    if (!detector) return tl::unexpected<Error>(detector.error());
    search.detector = std::move(*detector);
    return search;
  }
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<Board> boards, ReadBoards(options.board_path));
  std::optional<Camera> camera;
  if (!options.camera_path.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const Camera read, ReadCamera(options.camera_path));
    camera = read;
  }
  Expected<BoardFinder> finder = BoardFinder::Make(boards, camera, options.detector);
  if (!finder) {
    return MakeError(finder.error().code,
                     fmt::format("{}: {}", options.board_path, finder.error().message));
  }
  search.finder = std::move(*finder);
  return search;
}

void ExplainAll(const Search& search, const cv::Mat& grey, ImageReport& report) {
  const std::vector<Board>& boards = search.finder->boards();
  const Camera* camera = search.finder->camera() ? &*search.finder->camera() : nullptr;
  TagTrials trials(grey);
  for (const SeenBoard& seen : report.seen.boards) {
    const BoardPose* pose = seen.pose && *seen.pose ? &**seen.pose : nullptr;
    for (const std::size_t tag : seen.missing_tags) {
      MissingTag why{.cause = MissingCause::kNotThere, .text = "not examined (--quick)"};
      if (search.explain) why = ExplainMissing(trials, boards[seen.index].tags[tag], camera, pose);
      report.missing.push_back({.board = seen.index, .tag = tag, .why = std::move(why)});
    }
  }
}

Expected<ImageReport> Examine(const Search& search, const cv::Mat& image) {
  ImageReport report{.path = {}, .size = image.size()};
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat grey, ToGrey(image));
  if (search.finder) {
    SEXTANT_ASSIGN_OR_RETURN(SeenBoards seen, search.finder->Find(grey));
    report.seen = std::move(seen);
    ExplainAll(search, grey, report);
    return report;
  }
  SEXTANT_ASSIGN_OR_RETURN(Detections found, search.detector->Detect(grey));
  report.sought_checkers = search.detector->name().starts_with("checkerboard");
  report.seen.other_tags = std::move(found.tags);
  report.checkers = std::move(found.checkers);
  const bool is_empty = report.seen.other_tags.empty() && report.checkers.empty();
  if (is_empty && search.explain) report.other_families = OtherFamilies(FindFamilies(grey), "", {});
  return report;
}

// out.png for one image; out-NAME.png for each of many.
std::filesystem::path OverlayPath(const DetectOptions& options, const std::string& image) {
  std::filesystem::path out(options.overlay_path);
  if (options.images.size() == 1) return out;
  return out.parent_path() /
         (out.stem().string() + "-" + std::filesystem::path(image).stem().string() +
          out.extension().string());
}

// `drawn`: what becomes of the overlay, without which there is still a result.
ImageResult ExamineFile(const Search& search, const DetectOptions& options, const std::string& path,
                        Expected<void>& drawn) {
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat image, ReadImage(path));
  Expected<ImageReport> report = Examine(search, image);
  if (!report) {
    return MakeError(report.error().code, fmt::format("{}: {}", path, report.error().message));
  }
  report->path = path;
  if (!options.overlay_path.empty()) {
    drawn = WriteImage(DrawDetection(image, *report, search.Boards(), search.GetCamera()),
                       OverlayPath(options, path));
  }
  return report;
}

bool FoundSomething(const ImageReport& report) {
  if (!report.seen.other_tags.empty() || !report.checkers.empty()) return true;
  return std::ranges::any_of(report.seen.boards, [](const SeenBoard& board) {
    return !board.tags.empty() || board.checker;
  });
}

// The overlays, before any of them is written: none may be one of the images, or another overlay.
Expected<void> CheckOverlays(const DetectOptions& options) {
  if (options.overlay_path.empty()) return {};
  for (const std::string& image : options.images) {
    SEXTANT_RETURN_IF_ERROR(ClaimOutput(OverlayPath(options, image)));
  }
  for (const std::string& image : options.images) SEXTANT_RETURN_IF_ERROR(CheckInput(image));
  return {};
}

int Run(const DetectOptions& options) {
  const Expected<Search> search = MakeSearch(options);
  if (!search) return Refuse("detect", search.error());
  if (const Expected<void> ok = CheckOverlays(options); !ok) return Refuse("detect", ok.error());
  std::vector<ImageResult> results(options.images.size());
  std::vector<Expected<void>> drawn(options.images.size());
  {
    Progress progress;
    ProgressCounter counter(progress.Callback(), "images", results.size());
    tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t i) {
      results[i] = ExamineFile(*search, options, options.images[i], drawn[i]);
      counter.Step();
    });
  }
  std::string text;
  bool any_failed = false;
  bool any_found = false;
  for (const ImageResult& result : results) {
    if (!result) {
      Refuse("detect", result.error());
      any_failed = true;
      continue;
    }
    any_found = any_found || FoundSomething(*result);
    text += DescribeDetection(*result, search->Boards());
  }
  const int exit_code = any_failed ? kWrongUse : any_found ? kAnswered : kNoAnswer;
  int code = Deliver("detect", options.json_path, text,
                     FormatDetections(options.images, results, search->Boards()), exit_code);
  for (const Expected<void>& overlay : drawn) {
    if (!overlay) code = Refuse("detect", overlay.error());
  }
  return code;
}

}  // namespace

Command DetectCommand() {
  constexpr const char* kFooter =
      "Examples:\n"
      "  sextant detect photo.jpg --board board.yaml --camera camera.yaml --overlay out.png\n"
      "  sextant detect *.png --detector 'aruco(dictionary=6x6_250)' --json -";
  return MakeCommand<DetectOptions>(
      "detect", "Tags and boards in images: corners, poses, and why a tag is missing", kFooter,
      Declare, Run);
}

}  // namespace sextant::cli
