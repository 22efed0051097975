// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "cli/commands.h"
#include "cli/load.h"
#include "cli/mark/display_check.h"
#include "cli/mark/mark_canvas.h"
#include "cli/mark/mark_input.h"
#include "cli/mark/mark_window.h"
#include "io/boards/polygon_file.h"
#include "io/text/text_file.h"

namespace sextant::cli {
namespace {

// Keeps the files beside the window: --out on demand, the autosave whenever the marks differ from
// what is saved.
class Keeper {
 public:
  Keeper(const MarkOptions& options, MarkController& controller, bool is_saved)
      : options_(options), controller_(controller), out_is_current_(is_saved) {}

  void Save() {
    const std::string text = FormatPolygons(controller_.session().marks());
    if (const Expected<void> ok = WriteFileAtomically(options_.out_path, text); !ok) {
      controller_.Say(ok.error().message, false);
      return;
    }
    controller_.Say("saved " + options_.out_path, true);
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
    const Expected<void> ok =
        WriteFileAtomically(AutosavePath(options_), FormatPolygons(session.marks()));
    if (!ok) controller_.Say(ok.error().message, false);
  }

  /// Whether --out holds the marks; until the first save that is known only of those it began with.
  bool IsSaved() const { return out_is_current_ && controller_.session().IsSaved(); }

 private:
  void RemoveAutosave() {
    std::error_code ignored;
    std::filesystem::remove(AutosavePath(options_), ignored);
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

int Render(const std::string& path, const MarkController& controller, MarkCanvas& canvas) {
  std::vector<unsigned char> bytes;
  if (!path.ends_with(".png") || !cv::imencode(".png", canvas.Draw(controller), bytes)) {
    return Refuse("mark", {ErrorCode::kInvalidOption, path + ": expected a name in .png"});
  }
  const Expected<void> ok = WriteFileAtomically(path, std::string(bytes.begin(), bytes.end()));
  return ok ? kAnswered : Refuse("mark", ok.error());
}

}  // namespace

int RunMark(const MarkOptions& options) {
  const bool renders = !options.render_path.empty();
  if (const Expected<void> ok = CheckDisplay(); !renders && !ok) return Refuse("mark", ok.error());
  Expected<MarkInput> input = LoadMarkInput(options);
  if (!input) return Refuse("mark", input.error());
  const MarkViewport viewport(options.width_px, options.height_px, kMarkBar_px,
                              input->marks.camera.width_px, input->marks.camera.height_px);
  MarkController controller(MarkSession(std::move(input->returns), input->marks, options.ids),
                            viewport, !input->photo.empty());
  controller.Say(input->note, false);
  MarkCanvas canvas(input->photo);
  if (renders) return Render(options.render_path, controller, canvas);

  Keeper keeper(options, controller, input->is_saved);
  const Expected<void> shown =
      RunMarkWindow(controller, canvas,
                    {.save = [&] { keeper.Save(); }, .changed = [&] { keeper.KeepUnsaved(); }});
  if (!shown) return Refuse("mark", shown.error());
  const std::string summary = SummaryOf(controller.session().marks());
  if (!keeper.IsSaved()) {
    fmt::print(stderr, "sextant mark: not saved: {}; kept in {}, the next start goes on with it\n",
               summary, AutosavePath(options).string());
    return kNoAnswer;
  }
  std::error_code ignored;
  if (!std::filesystem::exists(options.out_path, ignored)) {
    fmt::print(stderr, "sextant mark: nothing marked, nothing written\n");
    return kNoAnswer;
  }
  fmt::print("{}: {}\n", options.out_path, summary);
  return kAnswered;
}

}  // namespace sextant::cli
