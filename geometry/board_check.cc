// SPDX-License-Identifier: Apache-2.0
#include "geometry/board_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>

namespace sextant {
namespace {

using Quad = std::array<Eigen::Vector2d, 4>;
using Part = BoardFault::Part;

// Files have decimal numbers: parts that touch exactly there may overlap by rounding.
constexpr double kTouch_m = 1e-9;
constexpr double kSamePlace_m = 1e-3;  // Between openings, after a turn of their board.

Quad Rectangle(const Eigen::Vector2d& center, double width, double height) {
  const double a = 0.5 * width;
  const double b = 0.5 * height;
  return {center + Eigen::Vector2d(-a, -b), center + Eigen::Vector2d(a, -b),
          center + Eigen::Vector2d(a, b), center + Eigen::Vector2d(-a, b)};
}

Quad HoleCorners(const BoardHole& hole) {
  return Rectangle(hole.center_in_board_m, hole.width_m, hole.height_m);
}

Quad CheckerCorners(const BoardChecker& checker) {
  return Rectangle(checker.center_in_board_m, (checker.inner_columns + 1) * checker.square_m,
                   (checker.inner_rows + 1) * checker.square_m);
}

// Whether an edge of `a` has all of `b` on its outer side: convex shapes that do not overlap have
// such an edge (separating axis theorem).
bool HasSeparatingEdge(const Quad& a, const Quad& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector2d along = (a[(i + 1) % a.size()] - a[i]).normalized();
    const Eigen::Vector2d outward(along.y(), -along.x());
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& corner : b) {
      nearest = std::min(nearest, outward.dot(corner - a[i]));
    }
    if (nearest >= -kTouch_m) return true;
  }
  return false;
}

bool Overlap(const Quad& a, const Quad& b) {
  return !HasSeparatingEdge(a, b) && !HasSeparatingEdge(b, a);
}

bool IsOnBoard(const Board& board, const Quad& part) {
  return std::all_of(part.begin(), part.end(), [&](const Eigen::Vector2d& corner) {
    return std::abs(corner.x()) <= 0.5 * board.top_right_m + kTouch_m &&
           std::abs(corner.y()) <= 0.5 * board.right_bottom_m + kTouch_m;
  });
}

double DistanceFromQuad(const Quad& quad, const Eigen::Vector2d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (std::size_t i = 0; i < quad.size(); ++i) {
    const Eigen::Vector2d side = quad[(i + 1) % quad.size()] - quad[i];
    const Eigen::Vector2d arm = point - quad[i];
    const double share = std::clamp(arm.dot(side) / side.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (arm - share * side).norm());
    inside = inside && side.x() * arm.y() - side.y() * arm.x() >= 0.0;
  }
  return inside ? 0.0 : nearest;
}

bool Overlap(const Quad& quad, const RoundHole& hole) {
  return DistanceFromQuad(quad, hole.center_in_board_m) < hole.radius_m - kTouch_m;
}

bool IsPositive(double size) { return size > 0.0 && std::isfinite(size); }

std::string InMetres(double size) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", size);
  return std::string(text.data()) + " m? sizes are in metres";
}

std::optional<BoardFault> BadSize(Part part, int tag, const char* field, double size) {
  if (IsPositive(size)) {
    const std::optional<std::string> doubt = DoubtfulSize(size);
    return doubt ? std::optional(BoardFault{part, tag, field, *doubt}) : std::nullopt;
  }
  return BoardFault{part, tag, field, "expected more than zero, got " + std::to_string(size)};
}

std::optional<BoardFault> FindSizeFault(const Board& board) {
  if (auto bad = BadSize(Part::kBoard, 0, "top_right_m", board.top_right_m)) return bad;
  if (auto bad = BadSize(Part::kBoard, 0, "right_bottom_m", board.right_bottom_m)) return bad;
  if (!(board.thickness_m >= 0.0) || !std::isfinite(board.thickness_m)) {
    return BoardFault{Part::kBoard, 0, "thickness_m", "expected zero or more"};
  }
  if (board.thickness_m > 0.5 * std::max(board.top_right_m, board.right_bottom_m)) {
    return BoardFault{Part::kBoard, 0, "thickness_m", InMetres(board.thickness_m)};
  }
  return std::nullopt;
}

std::optional<BoardFault> FindHoleFault(const Board& board) {
  const BoardHole& hole = *board.hole;
  if (auto bad = BadSize(Part::kHole, 0, "width_m", hole.width_m)) return bad;
  if (auto bad = BadSize(Part::kHole, 0, "height_m", hole.height_m)) return bad;
  const Eigen::Vector2d room = 0.5 * Eigen::Vector2d(board.top_right_m, board.right_bottom_m) -
                               0.5 * Eigen::Vector2d(hole.width_m, hole.height_m);
  const Eigen::Vector2d shift = hole.center_in_board_m.cwiseAbs();
  if (!(shift.x() < room.x() && shift.y() < room.y())) {
    return BoardFault{Part::kHole, 0, "", "expected the opening to lie within the board"};
  }
  return std::nullopt;
}

std::optional<BoardFault> FindRoundHoleFault(const Board& board, int index) {
  const auto i = static_cast<std::size_t>(index);
  const RoundHole& hole = board.round_holes[i];
  if (auto bad = BadSize(Part::kRoundHole, index, "radius_m", hole.radius_m)) return bad;
  const Eigen::Vector2d room = 0.5 * Eigen::Vector2d(board.top_right_m, board.right_bottom_m) -
                               hole.center_in_board_m.cwiseAbs();
  if (!(room.minCoeff() > hole.radius_m)) {
    return BoardFault{Part::kRoundHole, index, "", "expected the hole to lie within the board"};
  }
  if (board.hole && Overlap(HoleCorners(*board.hole), hole)) {
    return BoardFault{Part::kRoundHole, index, "", "it overlaps the board's opening"};
  }
  for (std::size_t k = 0; k < i; ++k) {
    const RoundHole& other = board.round_holes[k];
    const double apart = (other.center_in_board_m - hole.center_in_board_m).norm();
    if (apart < other.radius_m + hole.radius_m - kTouch_m) {
      return BoardFault{Part::kRoundHole, index, "",
                        "it overlaps the round hole " + std::to_string(k)};
    }
  }
  return std::nullopt;
}

// Fault of the position of a print that covers `quad`.
std::optional<BoardFault> FindPlaceFault(const Board& board, Part part, int tag, const Quad& quad) {
  if (!IsOnBoard(board, quad)) {
    return BoardFault{part, tag, "center_in_board_m", "it reaches over the board's edge"};
  }
  if (board.hole && Overlap(quad, HoleCorners(*board.hole))) {
    return BoardFault{part, tag, "center_in_board_m", "it reaches into the board's hole"};
  }
  if (std::ranges::any_of(board.round_holes,
                          [&](const RoundHole& hole) { return Overlap(quad, hole); })) {
    return BoardFault{part, tag, "center_in_board_m", "it reaches into a round hole of the board"};
  }
  return std::nullopt;
}

// Whether a tag lies within one white square of the checkerboard.
bool IsInWhiteSquare(const BoardChecker& checker, const Quad& tag) {
  const Eigen::Vector2i count(checker.inner_columns + 1, checker.inner_rows + 1);
  const Eigen::Vector2d middle = 0.25 * (tag[0] + tag[1] + tag[2] + tag[3]);
  const Eigen::Vector2d at =
      (middle - checker.center_in_board_m) / checker.square_m + 0.5 * count.cast<double>();
  const Eigen::Vector2i cell = at.array().floor().cast<int>();
  if ((cell.array() < 0).any() || (cell.array() >= count.array()).any()) return false;
  if ((cell.sum() % 2 == 0) != checker.starts_white) return false;
  const Eigen::Vector2d center =
      checker.center_in_board_m +
      checker.square_m *
          (cell.cast<double>() + Eigen::Vector2d(0.5, 0.5) - 0.5 * count.cast<double>());
  return std::ranges::all_of(tag, [&](const Eigen::Vector2d& corner) {
    return (corner - center).cwiseAbs().maxCoeff() <= 0.5 * checker.square_m + kTouch_m;
  });
}

std::optional<BoardFault> FindCheckerFault(const Board& board) {
  const BoardChecker& checker = *board.checker;
  constexpr int kMaxCorners = 1000;
  const auto is_count = [](int count) { return count >= 2 && count <= kMaxCorners; };
  if (!is_count(checker.inner_columns)) {
    return BoardFault{Part::kChecker, 0, "inner_columns", "expected 2 to 1000 inner corners"};
  }
  if (!is_count(checker.inner_rows)) {
    return BoardFault{Part::kChecker, 0, "inner_rows", "expected 2 to 1000 inner corners"};
  }
  if (auto bad = BadSize(Part::kChecker, 0, "square_m", checker.square_m)) return bad;
  if (checker.holds_tags && board.tags.empty()) {
    return BoardFault{Part::kChecker, 0, "holds_tags", "expected tags in the white squares"};
  }
  return FindPlaceFault(board, Part::kChecker, 0, CheckerCorners(checker));
}

std::optional<BoardFault> FindTagFault(const Board& board, int index) {
  const BoardTag& tag = board.tags[static_cast<std::size_t>(index)];
  if (tag.family.empty()) {
    return BoardFault{Part::kTag, index, "family", "expected the name of a tag family"};
  }
  if (tag.id < 0) return BoardFault{Part::kTag, index, "id", "expected zero or more"};
  if (auto bad = BadSize(Part::kTag, index, "edge_m", tag.edge_m)) return bad;
  if (!std::isfinite(tag.rotation_rad)) {
    return BoardFault{Part::kTag, index, "rotation_deg", "expected a finite angle"};
  }
  const Quad quad = TagCorners(tag);
  if (auto bad = FindPlaceFault(board, Part::kTag, index, quad)) return bad;
  if (board.checker && Overlap(quad, CheckerCorners(*board.checker)) &&
      !(board.checker->holds_tags && IsInWhiteSquare(*board.checker, quad))) {
    return BoardFault{Part::kTag, index, "center_in_board_m",
                      board.checker->holds_tags
                          ? "it is not within a white square of the checkerboard"
                          : "it overlaps the checkerboard"};
  }
  for (int other = 0; other < index; ++other) {
    const BoardTag& before = board.tags[static_cast<std::size_t>(other)];
    if (before.id == tag.id && before.family == tag.family) {
      return BoardFault{
          Part::kTag, index, "id",
          "the id " + std::to_string(tag.id) + " of " + tag.family +
              " is on this board a second time; a detector cannot distinguish the two"};
    }
    // Boards have up to 1000 tags: most pairs are farther apart than their diagonals allow.
    const double reach_m = std::numbers::sqrt2 * 0.5 * (tag.edge_m + before.edge_m);
    const Eigen::Vector2d apart = tag.center_in_board_m - before.center_in_board_m;
    if (apart.squaredNorm() > reach_m * reach_m) continue;
    if (Overlap(quad, TagCorners(before))) {
      return BoardFault{
          Part::kTag, index, "center_in_board_m",
          "it overlaps the tag " + std::to_string(before.id) + " of " + before.family};
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> DoubtfulSize(double size_m) {
  constexpr double kMaxSize_m = 10.0;  // More than people make, print and carry.
  if (!(size_m > kMaxSize_m)) return std::nullopt;
  return InMetres(size_m);
}

std::array<Eigen::Vector2d, 4> TagCorners(const BoardTag& tag) {
  // y points down: a positive angle turns clockwise as seen.
  const Eigen::Rotation2Dd turn(tag.rotation_rad);
  Quad corners = Rectangle(Eigen::Vector2d::Zero(), tag.edge_m, tag.edge_m);
  for (Eigen::Vector2d& corner : corners) corner = tag.center_in_board_m + turn * corner;
  return corners;
}

std::vector<Eigen::Vector2d> CornersInBoard(const Board& board) {
  const Quad outer = Rectangle(Eigen::Vector2d::Zero(), board.top_right_m, board.right_bottom_m);
  std::vector<Eigen::Vector2d> corners(outer.begin(), outer.end());
  if (board.hole) {
    const Quad inner = HoleCorners(*board.hole);
    corners.insert(corners.end(), inner.begin(), inner.end());
  }
  return corners;
}

int SideAfterTurn(const Board& board, int side, int quarter_turns) {
  if (side < 0) return side;
  if (side < kFirstRim) return side / 4 * 4 + ((side - quarter_turns) % 4 + 4) % 4;
  const RoundHole& hole = board.round_holes[static_cast<std::size_t>(side - kFirstRim)];
  Eigen::Vector2d at = hole.center_in_board_m;
  for (int i = 0; i < (quarter_turns % 4 + 4) % 4; ++i) at = Eigen::Vector2d(at.y(), -at.x());
  const auto there = std::ranges::find_if(board.round_holes, [&](const RoundHole& other) {
    return (other.center_in_board_m - at).norm() < kSamePlace_m &&
           std::abs(other.radius_m - hole.radius_m) < kSamePlace_m;
  });
  if (there == board.round_holes.end()) return -1;
  return kFirstRim + static_cast<int>(there - board.round_holes.begin());
}

bool HolesAllowTurns(const Board& board, int quarter_turns) {
  if (board.hole) {
    const bool is_oblong = std::abs(board.hole->width_m - board.hole->height_m) >= kSamePlace_m;
    if (2.0 * board.hole->center_in_board_m.norm() >= kSamePlace_m) return false;
    if (quarter_turns % 2 != 0 && is_oblong) return false;
  }
  for (int i = 0; i < static_cast<int>(board.round_holes.size()); ++i) {
    if (SideAfterTurn(board, kFirstRim + i, quarter_turns) < 0) return false;
  }
  return true;
}

std::optional<BoardFault> FindBoardFault(const Board& board) {
  if (auto fault = FindSizeFault(board)) return fault;
  if (board.hole) {
    if (auto fault = FindHoleFault(board)) return fault;
  }
  for (int i = 0; i < static_cast<int>(board.round_holes.size()); ++i) {
    if (auto fault = FindRoundHoleFault(board, i)) return fault;
  }
  if (board.checker) {
    if (auto fault = FindCheckerFault(board)) return fault;
  }
  for (int i = 0; i < static_cast<int>(board.tags.size()); ++i) {
    if (auto fault = FindTagFault(board, i)) return fault;
  }
  return std::nullopt;
}

}  // namespace sextant
