// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "geometry/scan_marks.h"
#include "report/projected_scan.h"

namespace sextant::cli {

enum class MarkMode {
  kEdges,    ///< Quadrilaterals around the edges, in the projected scan.
  kCorners,  ///< Corners of the boards, in the photo.
};

/// The state of `sextant mark` and the actions that change it, without a window.
///
/// Boards have slots from left to right. Clicks fill the selected one: four clicks make a
/// quadrilateral; four quadrilaterals (top-left edge first, clockwise) or four corners (from the
/// top, clockwise) make a board, and the next slot is selected.
class MarkSession {
 public:
  /// Continues with `marks`, which contain the projection of `returns`. `ids`: of the boards from
  /// left to right; further boards get the numbers that follow.
  MarkSession(std::vector<ProjectedReturn> returns, ScanMarks marks, std::vector<int> ids = {});

  const ScanMarks& marks() const { return state_.marks; }
  const std::vector<ProjectedReturn>& returns() const { return returns_; }
  MarkMode mode() const { return state_.mode; }
  int selected_id() const { return IdOf(state_.slot); }
  /// A message about the last action; may be empty.
  const std::string& note() const { return note_; }

  /// Rounded to 0.01 pixels.
  void Click(const Eigen::Vector2d& clicked);
  /// Undoes the last change of any kind; false if there is none.
  bool Undo();
  bool Redo();
  /// Deletes the marks of this mode on the selected board, or on the previous one if it has none.
  void DeleteBoard();
  /// Moves the selection by `by` slots to the right, at most to the first empty slot.
  void SelectBoard(int by);
  void SetMode(MarkMode mode);

  /// Whether nothing has changed since the last MarkSaved().
  bool IsSaved() const { return revision_ == saved_revision_; }
  void MarkSaved() { saved_revision_ = revision_; }
  /// Differs after each change of the marks.
  int revision() const { return revision_; }

  /// What to click next.
  std::string Prompt() const;
  /// Problems of the marks so far: boards out of order, edges with too few returns.
  std::vector<std::string> Warnings() const;

 private:
  struct State {
    ScanMarks marks{};
    MarkMode mode = MarkMode::kEdges;
    int slot = 0;
    int revision = 0;
  };

  int IdOf(int slot) const;
  int SlotOf(int id) const;
  int FirstEmptySlot() const;
  int EdgesIn(int slot) const;
  int CornersIn(int slot) const;
  bool IsEmpty(int slot) const;
  /// To be called before each change of state_. `of_marks` is false if only the selection changes.
  void BeginChange(bool of_marks = true);
  void ClickEdge(const Eigen::Vector2d& pixel);
  void ClickCorner(const Eigen::Vector2d& pixel);
  void AddEdge(const Quadrilateral& quadrilateral);

  std::vector<ProjectedReturn> returns_;
  std::vector<int> ids_;
  State state_;
  std::vector<State> undo_;
  std::vector<State> redo_;
  std::string note_;
  int revision_ = 0;
  int latest_revision_ = 0;
  int saved_revision_ = 0;
};

}  // namespace sextant::cli
