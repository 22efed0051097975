// SPDX-License-Identifier: Apache-2.0
#include "cli/mark/mark_session.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/board.h"

namespace sextant::cli {
namespace {

constexpr std::size_t kMaxUndo = 1000;
constexpr int kMinRings = 2;          // A line needs two.
constexpr double kMinArea_px2 = 4.0;  // A smaller area is an accidental click.
constexpr std::array<const char*, 4> kEdgeNames = {"top-left", "top-right", "bottom-right",
                                                   "bottom-left"};
constexpr std::array<const char*, 4> kCornerNames = {"top", "right", "bottom", "left"};

double AreaOf(const Quadrilateral& q) {
  const Eigen::Vector2d a = q[2] - q[0];
  const Eigen::Vector2d b = q[3] - q[1];
  return 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
}

// The same corners in an order in which the outline does not cross itself.
Quadrilateral Uncrossed(const Quadrilateral& q) {
  for (const Quadrilateral& candidate :
       {q, Quadrilateral{q[0], q[1], q[3], q[2]}, Quadrilateral{q[0], q[2], q[1], q[3]}}) {
    if (!CrossesItself(candidate)) return candidate;
  }
  return q;
}

double MiddleOf(const MarkedBoard& board) {
  double sum = 0.0;
  for (const Quadrilateral& edge : board.edges) sum += CenterOf(edge).x();
  return sum / static_cast<double>(board.edges.size());
}

std::size_t Index(int i) { return static_cast<std::size_t>(i); }

}  // namespace

MarkSession::MarkSession(std::vector<ProjectedReturn> returns, ScanMarks marks,
                         std::vector<int> ids)
    : returns_(std::move(returns)), ids_(std::move(ids)) {
  state_.marks = std::move(marks);
  for (const MarkedBoard& board : state_.marks.boards) {
    if (SlotOf(board.id) < 0) ids_.push_back(board.id);
  }
  for (const ClickedCorner& corner : state_.marks.corners) {
    if (SlotOf(corner.board) < 0) ids_.push_back(corner.board);
  }
  // Select the first incomplete board.
  while (EdgesIn(state_.slot) == kCornersPerBoard) ++state_.slot;
}

int MarkSession::IdOf(int slot) const {
  if (slot < static_cast<int>(ids_.size())) return ids_[Index(slot)];
  const int beyond = slot - static_cast<int>(ids_.size());
  return ids_.empty() ? beyond : *std::ranges::max_element(ids_) + 1 + beyond;
}

int MarkSession::SlotOf(int id) const {
  const auto found = std::ranges::find(ids_, id);
  return found == ids_.end() ? -1 : static_cast<int>(found - ids_.begin());
}

int MarkSession::EdgesIn(int slot) const {
  const auto found = std::ranges::find(state_.marks.boards, IdOf(slot), &MarkedBoard::id);
  return found == state_.marks.boards.end() ? 0 : static_cast<int>(found->edges.size());
}

int MarkSession::CornersIn(int slot) const {
  return static_cast<int>(
      std::ranges::count(state_.marks.corners, IdOf(slot), &ClickedCorner::board));
}

bool MarkSession::IsEmpty(int slot) const {
  const bool drawing = slot == state_.slot && !state_.marks.unfinished.empty();
  return EdgesIn(slot) == 0 && CornersIn(slot) == 0 && !drawing;
}

int MarkSession::FirstEmptySlot() const {
  int slot = 0;
  for (int i = 0; i <= static_cast<int>(ids_.size()); ++i) {
    if (!IsEmpty(i)) slot = i + 1;
  }
  return slot;
}

void MarkSession::BeginChange(bool of_marks) {
  if (undo_.size() == kMaxUndo) undo_.erase(undo_.begin());
  state_.revision = revision_;
  undo_.push_back(state_);
  redo_.clear();
  note_.clear();
  if (of_marks) revision_ = ++latest_revision_;
}

bool MarkSession::Undo() {
  note_.clear();
  if (undo_.empty()) {
    note_ = "nothing to undo";
    return false;
  }
  state_.revision = revision_;
  redo_.push_back(std::move(state_));
  state_ = std::move(undo_.back());
  undo_.pop_back();
  revision_ = state_.revision;
  return true;
}

bool MarkSession::Redo() {
  note_.clear();
  if (redo_.empty()) {
    note_ = "nothing to redo";
    return false;
  }
  state_.revision = revision_;
  undo_.push_back(std::move(state_));
  state_ = std::move(redo_.back());
  redo_.pop_back();
  revision_ = state_.revision;
  return true;
}

void MarkSession::Click(const Eigen::Vector2d& clicked) {
  // No hand is steadier than that, and people read the file too.
  const Eigen::Vector2d pixel = (clicked * 100.0).array().round() / 100.0;
  if (state_.mode == MarkMode::kEdges) {
    ClickEdge(pixel);
  } else {
    ClickCorner(pixel);
  }
}

void MarkSession::ClickEdge(const Eigen::Vector2d& pixel) {
  if (EdgesIn(state_.slot) == kCornersPerBoard) {
    note_ = fmt::format("board {} has all its edges: n for the next board, d to draw it again",
                        selected_id());
    return;
  }
  BeginChange();
  std::vector<Eigen::Vector2d>& drawn = state_.marks.unfinished;
  drawn.push_back(pixel);
  if (drawn.size() < 4) return;
  const Quadrilateral quadrilateral = Uncrossed({drawn[0], drawn[1], drawn[2], drawn[3]});
  drawn.clear();
  if (AreaOf(quadrilateral) < kMinArea_px2 || CrossesItself(quadrilateral)) {
    note_ = "these four clicks enclose no area: draw the quadrilateral again";
    return;
  }
  AddEdge(quadrilateral);
}

void MarkSession::AddEdge(const Quadrilateral& quadrilateral) {
  std::vector<MarkedBoard>& boards = state_.marks.boards;
  const int id = selected_id();
  auto board = std::ranges::find(boards, id, &MarkedBoard::id);
  if (board == boards.end()) {
    // The file lists boards from left to right, so insert before the boards of later slots.
    if (SlotOf(id) < 0) ids_.push_back(id);
    const auto after = [&](const MarkedBoard& other) { return SlotOf(other.id) > state_.slot; };
    board = boards.insert(std::ranges::find_if(boards, after), {.id = id, .edges = {}});
  }
  board->edges.push_back(quadrilateral);
  const ReturnCount count = CountReturns(returns_, quadrilateral);
  note_ = fmt::format("{} edge of board {}: {} returns", kEdgeNames[board->edges.size() - 1], id,
                      count.returns);
  if (count.rings > 0) note_ += fmt::format(" on {} rings", count.rings);
  if (board->edges.size() == 4) state_.slot += 1;
}

void MarkSession::ClickCorner(const Eigen::Vector2d& pixel) {
  const int count = CornersIn(state_.slot);
  if (count >= kCornersPerBoard) {
    note_ = fmt::format("board {} has all its corners: n for the next board, d to click them again",
                        selected_id());
    return;
  }
  BeginChange();
  const int id = selected_id();
  if (SlotOf(id) < 0) ids_.push_back(id);
  std::vector<ClickedCorner>& corners = state_.marks.corners;
  const auto of_this = [id](const ClickedCorner& corner) { return corner.board == id; };
  int next = 0;
  while (std::ranges::any_of(corners, [&](const ClickedCorner& corner) {
    return of_this(corner) && corner.corner == next;
  })) {
    ++next;
  }
  corners.push_back({.board = id, .corner = next, .pixel = pixel});
  note_ = fmt::format("{} corner of board {}", kCornerNames[Index(next % 4)], id);
  if (count + 1 == kCornersPerBoard) state_.slot += 1;
}

void MarkSession::DeleteBoard() {
  const auto has = [this](int slot) {
    if (state_.mode == MarkMode::kCorners) return CornersIn(slot) > 0;
    return EdgesIn(slot) > 0 || (slot == state_.slot && !state_.marks.unfinished.empty());
  };
  int slot = state_.slot;
  if (!has(slot)) --slot;
  if (slot < 0 || !has(slot)) {
    note_ = "no board to delete";
    return;
  }
  BeginChange();
  state_.slot = slot;
  const int id = selected_id();
  if (state_.mode == MarkMode::kEdges) {
    state_.marks.unfinished.clear();
    std::erase_if(state_.marks.boards, [id](const MarkedBoard& board) { return board.id == id; });
    note_ = fmt::format("edges of board {} deleted (u brings them back)", id);
  } else {
    std::erase_if(state_.marks.corners,
                  [id](const ClickedCorner& corner) { return corner.board == id; });
    note_ = fmt::format("corners of board {} deleted (u brings them back)", id);
  }
}

void MarkSession::SelectBoard(int by) {
  const int slot = std::clamp(state_.slot + by, 0, FirstEmptySlot());
  if (slot == state_.slot) return;
  BeginChange(!state_.marks.unfinished.empty());
  state_.marks.unfinished.clear();
  state_.slot = slot;
}

void MarkSession::SetMode(MarkMode mode) {
  if (mode == state_.mode) return;
  BeginChange(!state_.marks.unfinished.empty());
  state_.marks.unfinished.clear();
  state_.mode = mode;
  state_.slot = 0;
  const auto complete = [&] {
    const int count = mode == MarkMode::kEdges ? EdgesIn(state_.slot) : CornersIn(state_.slot);
    return count >= kCornersPerBoard;
  };
  while (complete()) ++state_.slot;
}

std::string MarkSession::Prompt() const {
  const int id = selected_id();
  if (state_.mode == MarkMode::kCorners) {
    const int corners = CornersIn(state_.slot);
    if (corners >= kCornersPerBoard) return fmt::format("Board {}: all corners marked", id);
    return fmt::format("Board {}: click its {} corner in the photo ({} of 4)", id,
                       kCornerNames[Index(corners)], corners + 1);
  }
  const int edges = EdgesIn(state_.slot);
  if (edges == kCornersPerBoard) return fmt::format("Board {}: all edges drawn", id);
  const std::size_t clicks = state_.marks.unfinished.size();
  if (edges == 0 && clicks == 0 && state_.slot > 0) {
    return fmt::format("Next board to the right ({}): its top-left edge, or s to save", id);
  }
  return fmt::format("Board {}, {} edge ({} of 4): click corner {} of 4 of an area around it", id,
                     kEdgeNames[Index(edges)], edges + 1, clicks + 1);
}

std::vector<std::string> MarkSession::Warnings() const {
  std::vector<std::string> warnings;
  double last = -std::numeric_limits<double>::infinity();
  for (const MarkedBoard& board : state_.marks.boards) {
    for (std::size_t i = 0; i < board.edges.size(); ++i) {
      const ReturnCount count = CountReturns(returns_, board.edges[i]);
      const bool few_rings = count.rings > 0 && count.rings < kMinRings;
      if (count.returns >= kMinRings && !few_rings) continue;
      warnings.push_back(
          fmt::format("board {}: its {} edge has returns of {} rings, and a line needs 2", board.id,
                      kEdgeNames[i], few_rings ? count.rings : count.returns));
    }
    if (board.edges.empty()) continue;
    const double middle = MiddleOf(board);
    if (middle < last) {
      warnings.push_back(fmt::format("board {} is to the left of the one before it", board.id));
    }
    last = middle;
  }
  return warnings;
}

}  // namespace sextant::cli
