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
  kEdges,    ///< Quadrilaterals round the edges, in the projected scan.
  kCorners,  ///< Corners of the boards, in the photo.
};

/// What `sextant mark` knows and what a person's doings change of it; no window.
///
/// Boards stand in slots from left to right. Clicks fill the selected one: four clicks make a
/// quadrilateral, four quadrilaterals (top-left edge first, clockwise) or four corners (from the
/// top, clockwise) make a board, and the next slot follows.
class MarkSession {
 public:
  /// Goes on with `marks`, which hold the projection of `returns`. `ids` of the boards from left to
  /// right; beyond them, and for none, they are counted on.
  MarkSession(std::vector<ProjectedReturn> returns, ScanMarks marks, std::vector<int> ids = {});

  const ScanMarks& marks() const { return state_.marks; }
  const std::vector<ProjectedReturn>& returns() const { return returns_; }
  MarkMode mode() const { return state_.mode; }
  int selected_id() const { return IdOf(state_.slot); }
  /// What the last doing led to, where that needs to be said.
  const std::string& note() const { return note_; }

  /// Rounded to 0.01 pixels.
  void Click(const Eigen::Vector2d& clicked);
  /// The last change that is not undone, whatever it was; false where there is none.
  bool Undo();
  bool Redo();
  /// What this mode has of the selected board, or of the one before where it has nothing.
  void DeleteBoard();
  /// By so many slots to the right; at most to the first empty one.
  void SelectBoard(int by);
  void SetMode(MarkMode mode);

  /// Whether there is nothing that the last MarkSaved() does not cover.
  bool IsSaved() const { return revision_ == saved_revision_; }
  void MarkSaved() { saved_revision_ = revision_; }
  /// Differs after each change of the marks.
  int revision() const { return revision_; }

  /// What to click next.
  std::string Prompt() const;
  /// What is wrong with the marks so far: boards out of order, edges that hold too little.
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
  /// To be called before a change; the change is then made on state_. What is selected changes
  /// without the marks.
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
