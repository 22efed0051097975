// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/board_finder.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "features/lidar/board_agreement.h"
#include "features/lidar/ring_clusters.h"
#include "features/lidar/scan_limits.h"

namespace sextant {
namespace {

constexpr double kMaxRunRatio = 1.6;  // A hand or a stand may extend a run beyond the board.
constexpr int kPlanesPerCluster = 3;  // Parts of a person who holds the board may be flat, too.
constexpr int kMinInCluster = 10;
constexpr double kAround_m = 0.05;
constexpr double kNearlyAll = 0.97;  // Fraction of a patch; the rest may be hands or a stand.
constexpr double kMinJump_m = 0.06;
constexpr double kJumpSigmas = 4.5;  // Three sigma of the difference of two returns.
// Limits of the diagonal of the box around a patch's points, relative to the board's diagonal. The
// ratio is half if the outermost rings miss the corners, sqrt 2 for a square held with one corner
// up, and more with a hand or a stand.
constexpr double kMinDiagonalRatio = 0.4;
constexpr double kMaxDiagonalRatio = 2.5;
constexpr std::size_t kNoProposal = std::numeric_limits<std::size_t>::max();
constexpr double kSameSize_m = 0.03;  // Boards closer in size are distinguished by their order.

double Diagonal(const Board& board) { return std::hypot(board.top_right_m, board.right_bottom_m); }

// Small if the outline agrees on all four sides and has many edge points. Compares boards on one
// patch and patches for one board.
double Disagreement(const BoardPatch& patch) {
  const auto edges = static_cast<double>(patch.edges.size());
  return (patch.fit.rms + 4.0 * (1.0 - patch.fit.share) + 2.0 * (1.0 - patch.agreement.filled) +
          2.0 * patch.agreement.continued + 2.0 * (kCornersPerBoard - patch.fit.sides_seen)) /
         std::sqrt(edges);
}

class Finder {
 public:
  Finder(const ScanRings& scan, std::span<const Board> boards, const BoardSearchOptions& options)
      : scan_(scan), boards_(boards), options_(options), random_(options.seed) {}

  BoardSearch Find() {
    double longest = 0.0;
    for (const Board& board : boards_) longest = std::max(longest, Diagonal(board));
    const ClusterOptions options{
        .longest_run_m = kMaxRunRatio * longest,
        .jump_m = std::max(kMinJump_m, kJumpSigmas * scan_.range_sigma_m())};
    for (const RingCluster& cluster : ClusterRings(scan_, options)) {
      if (cluster.front().ring < cluster.back().ring) SearchCluster(cluster);
    }
    std::ranges::stable_sort(search_.rejected, std::greater<>{}, &RejectedPatch::points);
    Assign();
    return std::move(search_);
  }

 private:
  bool InRegion(const Eigen::Vector3d& point) const {
    return !options_.region || ((point.array() >= options_.region->low.array()).all() &&
                                (point.array() <= options_.region->high.array()).all());
  }

  void SearchCluster(const RingCluster& cluster) {
    std::vector<std::size_t> places;
    for (const RingRun& run : cluster) {
      for (std::size_t i = run.first; i < run.first + run.count; ++i) {
        if (InRegion(scan_.points()[i].point)) places.push_back(i);
      }
    }
    std::ranges::sort(places);
    for (int i = 0; i < kPlanesPerCluster; ++i) {
      if (static_cast<int>(places.size()) < kMinInCluster) return;
      if (!SearchPlane(places)) return;
    }
  }

  // Removes the points of the dominant plane from `places` and proposes boards on it; false if
  // there is no plane.
  bool SearchPlane(std::vector<std::size_t>& places) {
    std::vector<Eigen::Vector3d> points;
    points.reserve(places.size());
    for (const std::size_t place : places) points.push_back(scan_.points()[place].point);
    const std::optional<FoundPlane> found = FindPlane(points, PlaneSearchOf(), random_);
    if (!found) return false;
    std::vector<std::size_t> on_plane;
    std::vector<std::size_t> rest;
    std::size_t next = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const bool on = next < found->inliers.size() && found->inliers[next] == static_cast<int>(i);
      next += on ? 1U : 0U;
      (on ? on_plane : rest).push_back(places[i]);
    }
    places = std::move(rest);
    if (!OfBoardSize(found->plane, on_plane)) return true;
    if (Propose(found->plane, on_plane)) Erase(proposals_.back(), places);
    return true;
  }

  // Whether the patch is neither far smaller nor far larger than every board: a cheap test before
  // the expensive ones.
  bool OfBoardSize(const LidarPlane& plane, const std::vector<std::size_t>& on_plane) const {
    Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
    Eigen::Vector2d high = -low;
    for (const std::size_t place : on_plane) {
      const Eigen::Vector3d d = scan_.points()[place].point - plane.origin;
      const Eigen::Vector2d p(plane.x_axis.dot(d), plane.y_axis.dot(d));
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    const double diagonal = (high - low).norm();
    return std::ranges::any_of(boards_, [&](const Board& board) {
      return diagonal > kMinDiagonalRatio * Diagonal(board) &&
             diagonal < kMaxDiagonalRatio * Diagonal(board);
    });
  }

  // Removes the remaining points on or close in front of a board that was found: its noisiest
  // returns would make a second one.
  void Erase(const std::vector<BoardPatch>& proposal, std::vector<std::size_t>& places) const {
    const BoardPatch& patch = proposal.front();
    const Board& board = boards_[static_cast<std::size_t>(patch.board)];
    std::erase_if(places, [&](std::size_t place) {
      const std::optional<Eigen::Vector2d> there = patch.plane.Meet(scan_.points()[place].point);
      return there && BeyondBoard(patch, board, *there) < kAround_m;
    });
  }

  // Adds the boards that could be this patch to the proposals; false if none could.
  bool Propose(const LidarPlane& plane, const std::vector<std::size_t>& on_plane) {
    std::string why;
    std::vector<BoardPatch> accepted;
    for (std::size_t b = 0; b < boards_.size(); ++b) {
      std::optional<BoardPatch> patch = Place(b, plane, on_plane);
      if (!patch) {
        why = fmt::format("its edges do not fit a board of {:.3f} x {:.3f} m",
                          boards_[b].top_right_m, boards_[b].right_bottom_m);
        continue;
      }
      std::optional<std::string> reason = RejectionReason(*patch, boards_[b]);
      if (reason && patch->agreement.contained < kNearlyAll) {
        if (std::optional<BoardPatch> bare = WithoutHands(*patch); bare) {
          patch = std::move(bare);
          reason = RejectionReason(*patch, boards_[b]);
        }
      }
      if (reason) {
        why = *reason;
      } else {
        accepted.push_back(std::move(*patch));
      }
    }
    const bool any = !accepted.empty();
    if (!any) {
      search_.rejected.push_back(
          {plane.origin, RingsOf(on_plane), static_cast<int>(on_plane.size()), std::move(why)});
    } else {
      proposals_.push_back(std::move(accepted));
    }
    return any;
  }

  std::optional<BoardPatch> Place(std::size_t board, const LidarPlane& plane,
                                  const std::vector<std::size_t>& on_plane) const {
    BoardPatch patch{.board = static_cast<int>(board), .plane = plane, .on_plane = on_plane};
    patch.edges = FindEdgePoints(scan_, plane, on_plane, EdgeOptionsOf(boards_[board]));
    const std::optional<RectangleFit> fit = FitRectangle(patch.edges, boards_[board]);
    if (!fit) return std::nullopt;
    patch.fit = *fit;
    patch.agreement = AgreementOf(scan_, patch, boards_[board]);
    return patch;
  }

  // Hands, arms or a stand near the board's plane are mistaken for parts of it. Places the board
  // again, using only the points on or close around it as first placed.
  std::optional<BoardPatch> WithoutHands(const BoardPatch& patch) {
    const auto board = static_cast<std::size_t>(patch.board);
    std::vector<std::size_t> near;
    std::vector<Eigen::Vector3d> points;
    for (const std::size_t place : patch.on_plane) {
      const Eigen::Vector3d& point = scan_.points()[place].point;
      const std::optional<Eigen::Vector2d> there = patch.plane.Meet(point);
      if (!there || BeyondBoard(patch, boards_[board], *there) > kAround_m) continue;
      near.push_back(place);
      points.push_back(point);
    }
    const std::optional<FoundPlane> found = FindPlane(points, PlaneSearchOf(), random_);
    if (!found) return std::nullopt;
    std::vector<std::size_t> on_plane;
    for (const int i : found->inliers) on_plane.push_back(near[static_cast<std::size_t>(i)]);
    return Place(board, found->plane, on_plane);
  }

  PlaneSearch PlaneSearchOf() const {
    return {.threshold_m = std::max(kMinThreshold_m, kPlaneSigmas * scan_.range_sigma_m()),
            .iterations = 60,
            .smallest_share = 0.25};
  }

  EdgeOptions EdgeOptionsOf(const Board& board) const {
    return {
        .hollow = board.hole.has_value(), .correct = options_.correct_edges, .beam = options_.beam};
  }

  int RingsOf(const std::vector<std::size_t>& places) const {
    int rings = 0;
    int ring = 0;
    std::size_t last = scan_.points().size();
    for (const std::size_t place : places) {
      while (place >= scan_.first(ring + 1)) ++ring;
      rings += static_cast<std::size_t>(ring) != last ? 1 : 0;
      last = static_cast<std::size_t>(ring);
    }
    return rings;
  }

  // Assigns a different board to as many patches as possible (augmenting paths), the best-fitting
  // first; then orders boards of nearly the same size from left to right.
  void Assign() {
    for (std::vector<BoardPatch>& proposal : proposals_) {
      std::ranges::sort(proposal, {}, Disagreement);
    }
    std::ranges::stable_sort(proposals_, {}, [](const std::vector<BoardPatch>& proposal) {
      return Disagreement(proposal.front());
    });
    DropDuplicates();
    owner_.assign(boards_.size(), kNoProposal);
    for (std::size_t p = 0; p < proposals_.size(); ++p) {
      std::vector<bool> visited(boards_.size(), false);
      if (AssignBoard(p, visited)) continue;
      const BoardPatch& patch = proposals_[p].front();
      search_.rejected.push_back({patch.plane.At(patch.fit.center), patch.agreement.rings,
                                  patch.agreement.points,
                                  "better matches were found for every board of its size"});
    }
    for (std::size_t b = 0; b < boards_.size(); ++b) {
      if (owner_[b] == kNoProposal) continue;
      for (const BoardPatch& patch : proposals_[owner_[b]]) {
        if (patch.board == static_cast<int>(b)) search_.found.push_back(patch);
      }
    }
    OrderFromLeft();
    std::ranges::sort(search_.found, {}, &BoardPatch::board);
  }

  // If the clustering split one board, only the best-fitting part is kept.
  void DropDuplicates() {
    std::vector<std::vector<BoardPatch>> kept;
    for (std::vector<BoardPatch>& proposal : proposals_) {
      const BoardPatch& patch = proposal.front();
      const Eigen::Vector3d center = patch.plane.At(patch.fit.center);
      const double reach = 0.5 * Diagonal(boards_[static_cast<std::size_t>(patch.board)]);
      const bool is_known = std::ranges::any_of(kept, [&](const std::vector<BoardPatch>& other) {
        return (other.front().plane.At(other.front().fit.center) - center).norm() < reach;
      });
      if (!is_known) kept.push_back(std::move(proposal));
    }
    proposals_ = std::move(kept);
  }

  // Assigns a board to the proposal, reassigning others if necessary.
  bool AssignBoard(std::size_t proposal, std::vector<bool>& visited) {
    for (const BoardPatch& patch : proposals_[proposal]) {
      const auto board = static_cast<std::size_t>(patch.board);
      if (visited[board]) continue;
      visited[board] = true;
      if (owner_[board] == kNoProposal || AssignBoard(owner_[board], visited)) {
        owner_[board] = proposal;
        return true;
      }
    }
    return false;
  }

  bool SameSize(int a, int b) const {
    const Board& first = boards_[static_cast<std::size_t>(a)];
    const Board& second = boards_[static_cast<std::size_t>(b)];
    return std::abs(first.top_right_m - second.top_right_m) < kSameSize_m &&
           std::abs(first.right_bottom_m - second.right_bottom_m) < kSameSize_m &&
           first.hole.has_value() == second.hole.has_value();
  }

  // Orders boards of nearly the same size from left to right; refits patches whose board changes.
  void OrderFromLeft() {
    std::vector<BoardPatch>& found = search_.found;
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (std::size_t j = i + 1; j < found.size(); ++j) {
        BoardPatch& a = found[i];
        BoardPatch& b = found[j];
        if (!SameSize(a.board, b.board)) continue;
        // The left one has the larger azimuth.
        const bool a_is_left = a.plane.origin.cross(b.plane.origin).z() < 0.0;
        if (a_is_left == (a.board < b.board)) continue;
        std::swap(a.board, b.board);
        Refit(a);
        Refit(b);
      }
    }
  }

  void Refit(BoardPatch& patch) const {
    const Board& board = boards_[static_cast<std::size_t>(patch.board)];
    const std::optional<RectangleFit> fit = FitRectangle(patch.edges, board);
    if (!fit) return;
    patch.fit = *fit;
    patch.agreement = AgreementOf(scan_, patch, board);
  }

  const ScanRings& scan_;
  std::span<const Board> boards_;
  const BoardSearchOptions& options_;
  Random random_;
  BoardSearch search_;
  std::vector<std::size_t> owner_;                  // For each board, its proposal.
  std::vector<std::vector<BoardPatch>> proposals_;  // For each patch, every board that it may be.
};

}  // namespace

Expected<BoardSearch> FindBoards(const ScanRings& scan, std::span<const Board> boards,
                                 const BoardSearchOptions& options) {
  for (const Board& board : boards) {
    if (!(board.top_right_m > 0.0) || !(board.right_bottom_m > 0.0)) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("board {} has no size ({} x {} m)", board.id, board.top_right_m,
                                   board.right_bottom_m));
    }
  }
  if (boards.empty()) {
    return MakeError(ErrorCode::kInvalidInput, "no board to search for: its size must be known");
  }
  return Finder(scan, boards, options).Find();
}

}  // namespace sextant
