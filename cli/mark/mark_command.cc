// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>

#include "calibrate/observe/photo_file.h"
#include "cli/commands/commands.h"
#include "cli/mark/display_check.h"
#include "cli/mark/mark_canvas.h"
#include "cli/mark/mark_input.h"
#include "cli/mark/mark_window.h"
#include "cli/output.h"
#include "cli/pose_argument.h"
#include "io/boards/polygon_file.h"
#include "io/output/output_file.h"
#include "io/output/remove_file.h"
#include "io/output/standard_output.h"

namespace sextant::cli {
namespace {

void Declare(MarkOptions& options, Arguments& arguments) {
  arguments.Add("--cloud", options.cloud_path,
                "The scan: PCD, PLY, LAS, npy, KITTI .bin or a table (.csv, .xyz)",
                {.required = true});
  arguments.Add("--image", options.image_path, "Its photo");
  arguments.Add("--camera", options.camera_path,
                "Intrinsics; default: an assumed camera with a view of 90 degrees");
  arguments.Add("--cam-from-lidar", options.cam_from_lidar,
                "Rough pose: results (JSON), rts.txt, or X Y Z QW QX QY QZ; default: the camera\n"
                "looks along the LiDAR's x axis",
                {.min_values = 1, .max_values = 7});
  DeclarePoseIs(options.pose_is, arguments, "--cam-from-lidar");
  arguments.Add(
      "--yaw", options.yaw_deg,
      "Without a pose: turn the assumed camera to the left by this angle [deg]",
      {.shows_default = true, .range = {{-360.0, 360.0}}, .excludes = "--cam-from-lidar"});
  arguments.Add("--ids", options.ids, "Ids of the boards from left to right; default: 0, 1, ...",
                {.range = {{0, 1e9}}});
  arguments.Add("--out", options.out_path, "Polygon file to write, or to continue with",
                {.shows_default = true, .writes = Writes::kCheckedByCommand});
  arguments.Add("--render", options.render_path,
                "Write a picture (PNG) of the window instead of opening it",
                {.writes = Writes::kFile});
  arguments.Add("--width", options.width_px, "Width of the window [px]",
                {.shows_default = true, .range = {{320, 8192}}});
  arguments.Add("--height", options.height_px, "Height of the window [px]",
                {.shows_default = true, .range = {{240, 8192}}});
}

// Both files are read before the marks are drawn, and written again and again.
constexpr OutputUse kContinued{.may_be_read = true, .is_repeated = true};

Expected<void> ClaimMarks(const MarkOptions& options) {
  SEXTANT_RETURN_IF_ERROR(ClaimOutput(options.out_path, kContinued));
  return ClaimOutput(AutosavePath(options), kContinued);
}

// An existing file was read as marks at the start.
Expected<void> WriteMarks(const std::filesystem::path& path, const std::string& text) {
  return WriteFileAtomically(path, text, Replace::kAnyFile, kContinued);
}

// Writes --out on request, and the autosave file whenever the marks differ from what is saved.
class Keeper {
 public:
  Keeper(const MarkOptions& options, MarkController& controller, bool is_saved)
      : options_(options), controller_(controller), out_is_current_(is_saved) {}

  void Save() {
    const std::string text = FormatPolygons(controller_.session().marks());
    if (const Expected<void> ok = WriteMarks(options_.out_path, text); !ok) {
      controller_.ShowMessage(ok.error().message, false);
      return;
    }
    controller_.ShowMessage("saved " + options_.out_path, true);
    out_is_current_ = true;
    RemoveAutosave();
  }

  void KeepUnsaved() {
    const MarkSession& session = controller_.session();
    if (session.revision() == kept_revision_) return;
    kept_revision_ = session.revision();
    if (IsSaved()) {
      RemoveAutosave();
      return;
    }
    const Expected<void> ok = WriteMarks(AutosavePath(options_), FormatPolygons(session.marks()));
    if (!ok) controller_.ShowMessage(ok.error().message, false);
  }

  /// Whether --out holds the marks. Before the first save, only the initial marks can be in it.
  bool IsSaved() const { return out_is_current_ && controller_.session().IsSaved(); }

 private:
  void RemoveAutosave() {
    // What remains of it continues the next time.
    const Expected<void> ignored = RemoveFile(AutosavePath(options_), Replace::kAnyFile);
    static_cast<void>(ignored);
  }

  const MarkOptions& options_;
  MarkController& controller_;
  bool out_is_current_;
  int kept_revision_ = 0;
};

std::string Counted(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string SummaryOf(const ScanMarks& marks) {
  std::size_t edges = 0;
  for (const MarkedBoard& board : marks.boards) edges += board.edges.size();
  return fmt::format("{} with {}, {}", Counted(marks.boards.size(), "board"),
                     Counted(edges, "edge"), Counted(marks.corners.size(), "corner"));
}

Expected<void> CheckRenderPath(const std::string& path) {
  if (path.ends_with(".png")) return {};
  return MakeError(ErrorCode::kInvalidOption, path + ": expected a name that ends in .png");
}

int Render(const std::string& path, const MarkController& controller, MarkCanvas& canvas) {
  const Expected<void> ok = WriteImage(canvas.Draw(controller), path);
  return ok ? kAnswered : Refuse("mark", ok.error());
}

int Run(const MarkOptions& options) {
  const bool renders = !options.render_path.empty();
  if (const Expected<void> ok = CheckDisplay(); !renders && !ok) return Refuse("mark", ok.error());
  if (const Expected<void> ok =
          renders ? CheckRenderPath(options.render_path) : ClaimMarks(options);
      !ok) {
    return Refuse("mark", ok.error());
  }
  Expected<MarkInput> input = LoadMarkInput(options);
  if (!input) return Refuse("mark", input.error());
  const MarkViewport viewport(options.width_px, options.height_px, kMarkBar_px,
                              input->marks.camera.width_px, input->marks.camera.height_px);
  MarkController controller(MarkSession(std::move(input->returns), input->marks, options.ids),
                            viewport, !input->photo.empty());
  controller.ShowMessage(input->note, false);
  MarkCanvas canvas(input->photo);
  if (renders) return Render(options.render_path, controller, canvas);

  Keeper keeper(options, controller, input->is_saved);
  const Expected<void> shown =
      RunMarkWindow(controller, canvas,
                    {.save = [&] { keeper.Save(); }, .changed = [&] { keeper.KeepUnsaved(); }});
  if (!shown) return Refuse("mark", shown.error());
  const std::string summary = SummaryOf(controller.session().marks());
  if (!keeper.IsSaved()) {
    PrintError("sextant mark: not saved: {}; kept in {}, with which the next start continues\n",
               summary, AutosavePath(options).string());
    return kNoAnswer;
  }
  std::error_code ignored;
  if (!std::filesystem::exists(options.out_path, ignored)) {
    PrintError("sextant mark: nothing marked, nothing written\n");
    return kNoAnswer;
  }
  PrintText(WroteLine(options.out_path, summary));
  return kAnswered;
}

}  // namespace

Command MarkCommand() {
  constexpr const char* kFooter =
      "Draw an area of four clicks around each edge of a board, where the rings leave the board: "
      "the\n"
      "top-left edge first, then clockwise, boards from left to right. h shows the keys. Unsaved "
      "marks\n"
      "are kept next to the file of --out, and the next start continues with them.\n"
      "Examples:\n"
      "  sextant mark --cloud scan.pcd --yaw 90\n"
      "  sextant mark --cloud scan.pcd --image photo.png --camera camera.yaml --out session.yaml";
  return MakeCommand<MarkOptions>("mark", "Mark edges in a scan and corners in its photo by hand",
                                  kFooter, Declare, Run);
}

}  // namespace sextant::cli
