// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/polygon_edges.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "features/lidar/board_agreement.h"
#include "features/lidar/scan_limits.h"
#include "geometry/board_check.h"

namespace sextant {
namespace {

constexpr std::array<const char*, 4> kEdgeNames = {"top-left", "top-right", "bottom-right",
                                                   "bottom-left"};
constexpr int kMaxPlanes = 4;        // The board and objects in front of and behind it.
constexpr double kMinOutward = 0.1;  // Cosine; a ring parallel to an edge does not leave the board.
constexpr double kSquare_m = 0.005;

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Convex hull (Andrew 1979), oriented so that Cross > 0 at each side for points inside.
std::vector<Eigen::Vector2d> HullOf(const std::vector<Quadrilateral>& areas) {
  std::vector<Eigen::Vector2d> points;
  for (const Quadrilateral& area : areas) points.insert(points.end(), area.begin(), area.end());
  std::ranges::sort(points, [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  std::vector<Eigen::Vector2d> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t start = hull.size();
    for (const Eigen::Vector2d& p : points) {
      while (hull.size() >= start + 2 &&
             Cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();
    std::ranges::reverse(points);
  }
  return hull;
}

bool IsInHull(const std::vector<Eigen::Vector2d>& hull, const Eigen::Vector2d& pixel) {
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d& from = hull[i];
    if (Cross(hull[(i + 1) % hull.size()] - from, pixel - from) < 0.0) return false;
  }
  return true;
}

// One marked board; every message names its id.
class MarkedPatch {
 public:
  MarkedPatch(const ScanRings& scan, const ScanMarks& marks, const MarkedBoard& marked,
              const Board& board, const BoardSearchOptions& options)
      : scan_(scan), marked_(marked), board_(board), options_(options) {
    const std::vector<Eigen::Vector2d> hull = HullOf(marked.edges);
    for (std::size_t i = 0; i < scan.points().size(); ++i) {
      const std::optional<Eigen::Vector2d> pixel =
          Project(marks.camera, marks.cam_from_lidar * scan.points()[i].point);
      if (!pixel || !IsInHull(hull, *pixel)) continue;
      places_.push_back(i);
      areas_.push_back(0U);
      for (std::size_t edge = 0; edge < 4; ++edge) {
        if (Contains(marked.edges[edge], *pixel)) areas_.back() |= 1U << edge;
      }
    }
  }

  Expected<BoardPatch> Make(int place) {
    BoardPatch patch{.board = place};
    if (!ChoosePlane(patch)) {
      return Fail(
          ErrorCode::kDegenerate,
          fmt::format("no plane of the {} returns within its areas has returns in each of the four "
                      "areas; is this the scan that was marked?",
                      places_.size()));
    }
    std::vector<int> sides;
    for (std::size_t edge = 0; edge < 4; ++edge) {
      const std::vector<EdgePoint> ends = EndsIn(edge, patch);
      if (ends.empty()) {
        return Fail(ErrorCode::kTooFewPairs,
                    fmt::format("no ring ends on it within its {} area: draw the area so that it "
                                "reaches across the edge to where the rings leave the board",
                                kEdgeNames[edge]));
      }
      patch.edges.insert(patch.edges.end(), ends.begin(), ends.end());
      sides.resize(patch.edges.size(), SideOfMarkedEdge(static_cast<int>(edge)));
    }
    AddOthers(patch);
    return Place(std::move(patch), sides);
  }

 private:
  tl::unexpected<Error> Fail(ErrorCode code, const std::string& message) const {
    return MakeError(code, fmt::format("board {}: {}", marked_.id, message));
  }

  EdgeOptions EdgeOptionsFor(bool hollow) const {
    return {.hollow = hollow, .correct = options_.correct_edges, .beam = options_.beam};
  }

  // The nearest plane that has returns in all four areas.
  bool ChoosePlane(BoardPatch& patch) {
    Random random(options_.seed);
    std::vector<std::size_t> left(places_.size());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
    bool any = false;
    for (int k = 0; k < kMaxPlanes; ++k) {
      std::vector<Eigen::Vector3d> points;
      for (const std::size_t i : left) points.push_back(scan_.points()[places_[i]].point);
      const PlaneSearch search{
          .threshold_m = std::max(kMinThreshold_m, kPlaneSigmas * scan_.range_sigma_m()),
          .iterations = 200,
          .smallest_share = 0.1};
      const std::optional<FoundPlane> found = FindPlane(points, search, random);
      if (!found) break;
      std::vector<std::size_t> on_plane;
      unsigned areas = 0;
      for (const int inlier : found->inliers) {
        const std::size_t i = left[static_cast<std::size_t>(inlier)];
        on_plane.push_back(i);
        areas |= areas_[i];
      }
      const bool nearer = !any || found->plane.origin.norm() < patch.plane.origin.norm();
      if (areas == 0xFU && nearer) {
        patch.plane = found->plane;
        chosen_ = on_plane;
        any = true;
      }
      std::vector<std::size_t> rest;
      std::ranges::set_difference(left, on_plane, std::back_inserter(rest));
      left = std::move(rest);
    }
    for (const std::size_t i : chosen_) patch.on_plane.push_back(places_[i]);
    return any;
  }

  // The outer end of each ring in an area.
  std::vector<EdgePoint> EndsIn(std::size_t edge, const BoardPatch& patch) const {
    std::vector<std::size_t> in_area;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::size_t i : chosen_) {
      if ((areas_[i] & (1U << edge)) == 0U) continue;
      in_area.push_back(places_[i]);
      sum += scan_.points()[places_[i]].point;
    }
    const Eigen::Vector3d from_center =
        sum / static_cast<double>(in_area.size()) - patch.plane.origin;
    const Eigen::Vector2d outward(patch.plane.x_axis.dot(from_center),
                                  patch.plane.y_axis.dot(from_center));
    std::vector<EdgePoint> ends =
        FindEdgePoints(scan_, patch.plane, in_area, EdgeOptionsFor(false));
    std::erase_if(ends, [&](const EdgePoint& end) {
      return end.across || end.outward.dot(outward) < kMinOutward * outward.norm();
    });
    return ends;
  }

  // Adds edge points for which no area is drawn: ends between rings, and the opening.
  void AddOthers(BoardPatch& patch) const {
    const bool hollow = board_.hole || !board_.round_holes.empty();
    for (const EdgePoint& edge :
         FindEdgePoints(scan_, patch.plane, patch.on_plane, EdgeOptionsFor(hollow))) {
      if (edge.across || edge.inner) patch.edges.push_back(edge);
    }
  }

  // `sides`: the marked sides of the first edge points.
  Expected<BoardPatch> Place(BoardPatch patch, const std::vector<int>& sides) const {
    const std::optional<RectangleFit> fit = FitRectangle(patch.edges, board_);
    if (!fit) {
      return Fail(
          ErrorCode::kDegenerate,
          fmt::format("the {} ends of rings in its areas do not determine its pose", sides.size()));
    }
    patch.fit = *fit;
    const int turns = TurnsTo(sides, patch.fit.sides);
    const bool square = std::abs(board_.top_right_m - board_.right_bottom_m) < kSquare_m;
    if (turns % 2 != 0 && (!square || board_.hole || !board_.round_holes.empty())) {
      return Fail(
          ErrorCode::kInvalidInput,
          fmt::format("its sides of {} and {} m fit in exchanged order: mark the edge from corner "
                      "3 (left) to corner 0 (top) first, then clockwise",
                      board_.top_right_m, board_.right_bottom_m));
    }
    if (turns == 2 && !HolesAllowTurns(board_, 2)) {
      return Fail(ErrorCode::kInvalidInput,
                  "its openings are where they are only if it is turned by half a turn: mark the "
                  "edge from corner 3 (left) to corner 0 (top) first, then clockwise");
    }
    patch.fit.angle_rad += turns * 0.5 * std::numbers::pi;
    for (std::size_t i = 0; i < patch.fit.sides.size(); ++i) {
      int& side = patch.fit.sides[i];
      side = SideAfterTurn(board_, side, turns);
      if (i < sides.size()) side = sides[i];
    }
    patch.agreement = AgreementOf(scan_, patch, board_);
    return patch;
  }

  // The most frequent offset of the fitted side numbers from the marked ones.
  static int TurnsTo(const std::vector<int>& marked, const std::vector<int>& fitted) {
    std::array<int, 4> votes{};
    for (std::size_t i = 0; i < marked.size(); ++i) {
      if (fitted[i] < 0 || fitted[i] > 3) continue;
      ++votes[static_cast<std::size_t>((fitted[i] - marked[i] + 4) % 4)];
    }
    return static_cast<int>(std::ranges::max_element(votes) - votes.begin());
  }

  const ScanRings& scan_;
  const MarkedBoard& marked_;
  const Board& board_;
  const BoardSearchOptions& options_;
  std::vector<std::size_t> places_;  // The returns within the hull.
  std::vector<unsigned> areas_;      // For each of them, a bit for every area that contains it.
  std::vector<std::size_t> chosen_;  // Indices into both of those on the board's plane.
};

}  // namespace

Expected<std::vector<BoardPatch>> PatchesFromPolygons(const ScanRings& scan, const ScanMarks& marks,
                                                      std::span<const Board> boards,
                                                      const BoardSearchOptions& options) {
  if (marks.boards.empty()) {
    return MakeError(ErrorCode::kMissingData, "no board is marked: draw its edges in sextant mark");
  }
  std::vector<BoardPatch> patches;
  for (const MarkedBoard& marked : marks.boards) {
    if (marked.edges.size() != 4) {
      return MakeError(ErrorCode::kMissingData,
                       fmt::format("board {}: {} of its 4 edges are marked: mark the others in "
                                   "sextant mark",
                                   marked.id, marked.edges.size()));
    }
    const auto board = std::ranges::find(boards, marked.id, &Board::id);
    if (board == boards.end() || !(board->top_right_m > 0.0) || !(board->right_bottom_m > 0.0)) {
      return MakeError(
          ErrorCode::kInvalidInput,
          fmt::format("board {} is marked, but its size is not known: expected a board "
                      "of that id (--ids of sextant mark gives another)",
                      marked.id));
    }
    SEXTANT_ASSIGN_OR_RETURN(BoardPatch patch, MarkedPatch(scan, marks, marked, *board, options)
                                                   .Make(static_cast<int>(board - boards.begin())));
    patches.push_back(std::move(patch));
  }
  return patches;
}

}  // namespace sextant
