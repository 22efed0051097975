// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/board_finder.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "features/lidar/board_agreement.h"
#include "features/lidar/board_assignment.h"
#include "features/lidar/plane_rays.h"
#include "features/lidar/ring_clusters.h"
#include "features/lidar/round_holes.h"
#include "features/lidar/scan_limits.h"

namespace sextant {
namespace {

constexpr double kMaxRunRatio = 1.6;  // A hand or a stand may extend a run beyond the board.
constexpr int kPlanesPerCluster = 3;  // Parts of a person who holds the board may be flat, too.
constexpr int kMinInCluster = 10;
constexpr double kAround_m = 0.05;
constexpr double kRays_m =
    0.3;  // Around the points of a patch: wider than the bands of an outline.
constexpr double kMinJump_m = 0.06;
constexpr double kJumpSigmas = 4.5;     // Three sigma of the difference of two returns.
constexpr std::size_t kPlacements = 4;  // On a patch, compared by the rays that they explain.
// Limits of the diagonal of the box around a patch's points, relative to the board's diagonal. The
// ratio is half if the outermost rings miss the corners, sqrt 2 for a square held with one corner
// up, and more with a hand or a stand.
constexpr double kMinDiagonalRatio = 0.4;
constexpr double kMaxDiagonalRatio = 2.5;

double Diagonal(const Board& board) { return std::hypot(board.top_right_m, board.right_bottom_m); }

// The box around points of a plane, in its axes.
struct PlaneBox {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector2d high = Eigen::Vector2d::Constant(std::numeric_limits<double>::lowest());

  Eigen::Vector2d Middle() const { return 0.5 * (low + high); }
  double Diagonal() const { return (high - low).norm(); }
};

PlaneBox BoxOf(const ScanRings& scan, const LidarPlane& plane,
               const std::vector<std::size_t>& on_plane) {
  PlaneBox box;
  for (const std::size_t place : on_plane) {
    const Eigen::Vector3d d = scan.points()[place].point - plane.origin;
    const Eigen::Vector2d p(plane.x_axis.dot(d), plane.y_axis.dot(d));
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
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
    AssignBoards(scan_, boards_, std::move(proposals_), search_);
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
    const PlaneBox box = BoxOf(scan_, found->plane, on_plane);
    if (!OfBoardSize(box)) return true;
    if (Propose(found->plane, on_plane, box)) Erase(proposals_.back(), places);
    return true;
  }

  // Whether the patch is neither far smaller nor far larger than every board: a cheap test before
  // the expensive ones.
  bool OfBoardSize(const PlaneBox& box) const {
    return std::ranges::any_of(boards_, [&](const Board& board) {
      return box.Diagonal() > kMinDiagonalRatio * Diagonal(board) &&
             box.Diagonal() < kMaxDiagonalRatio * Diagonal(board);
    });
  }

  // Removes the remaining points on or close in front of a board that was found: its noisiest
  // returns would make a second one.
  void Erase(const PatchProposal& proposal, std::vector<std::size_t>& places) const {
    const BoardPatch& patch = proposal.front();
    const Board& board = boards_[static_cast<std::size_t>(patch.board)];
    std::erase_if(places, [&](std::size_t place) {
      const std::optional<Eigen::Vector2d> there = patch.plane.Meet(scan_.points()[place].point);
      return there && BeyondBoard(patch.fit, board, *there) < kAround_m;
    });
  }

  // Adds the boards that could be this patch to the proposals; false if none could.
  bool Propose(const LidarPlane& plane, const std::vector<std::size_t>& on_plane,
               const PlaneBox& box) {
    const PlaneRays rays = RaysAround(scan_, plane, box.Middle(), 0.5 * box.Diagonal() + kRays_m);
    std::string why;
    PatchProposal accepted;
    for (std::size_t b = 0; b < boards_.size(); ++b) {
      const std::optional<BoardPatch> patch = Place(b, plane, on_plane, rays);
      if (!patch) {
        why = fmt::format("its edges do not fit a board of {:.3f} x {:.3f} m",
                          boards_[b].top_right_m, boards_[b].right_bottom_m);
        continue;
      }
      if (std::optional<std::string> reason = RejectionReason(*patch, boards_[b])) {
        why = std::move(*reason);
      } else {
        accepted.push_back(*patch);
      }
    }
    if (accepted.empty()) {
      search_.rejected.push_back(
          {plane.origin, RingsOf(on_plane), static_cast<int>(on_plane.size()), std::move(why)});
      return false;
    }
    proposals_.push_back(std::move(accepted));
    return true;
  }

  // Places the board where it explains the rays best.
  std::optional<BoardPatch> Place(std::size_t board, const LidarPlane& plane,
                                  const std::vector<std::size_t>& on_plane, const PlaneRays& rays) {
    BoardPatch patch{.board = static_cast<int>(board), .plane = plane, .on_plane = on_plane};
    HoledEdges edges = EdgesOf(boards_[board], plane, on_plane);
    patch.edges = std::move(edges.edges);
    std::vector<RectangleFit> fits =
        FitRectangles(patch.edges, boards_[board], kPlacements, edges.starts);
    if (fits.empty()) return std::nullopt;
    for (RectangleFit& fit : fits) fit.cost += RayCost(rays, fit, boards_[board]);
    patch.fit = fits[MostUpright(fits, boards_[board])];
    return WithoutOthers(patch);
  }

  // Hands, a stand or a person in the board's plane were mistaken for parts of it. Places the board
  // again, using only the points on or close around it as first placed.
  std::optional<BoardPatch> WithoutOthers(const BoardPatch& first) {
    const Board& board = boards_[static_cast<std::size_t>(first.board)];
    std::vector<std::size_t> near;
    std::vector<Eigen::Vector3d> points;
    for (const std::size_t place : first.on_plane) {
      const Eigen::Vector3d& point = scan_.points()[place].point;
      const std::optional<Eigen::Vector2d> there = first.plane.Meet(point);
      if (!there || BeyondBoard(first.fit, board, *there) > kAround_m) continue;
      near.push_back(place);
      points.push_back(point);
    }
    BoardPatch patch{.board = first.board, .plane = first.plane};
    if (points.size() == first.on_plane.size()) {
      patch = first;
    } else {
      const std::optional<FoundPlane> found = FindPlane(points, PlaneSearchOf(), random_);
      if (!found) return std::nullopt;
      patch.plane = found->plane;
      for (const int i : found->inliers) {
        patch.on_plane.push_back(near[static_cast<std::size_t>(i)]);
      }
      patch.edges = EdgesOf(board, patch.plane, patch.on_plane).edges;
      const auto center = patch.plane.Meet(first.plane.At(first.fit.center));
      const Eigen::Vector2d x_axis(std::cos(first.fit.angle_rad), std::sin(first.fit.angle_rad));
      const Eigen::Vector3d along =
          first.plane.x_axis * x_axis.x() + first.plane.y_axis * x_axis.y();
      const double angle = std::atan2(patch.plane.y_axis.dot(along), patch.plane.x_axis.dot(along));
      if (!center) return std::nullopt;
      // Without the others, a board that is nearly square may fit better after a quarter turn.
      std::vector<RectangleFit> fits;
      for (const double turned : {angle, angle + 0.5 * std::numbers::pi}) {
        const std::optional<RectangleFit> fit =
            RefineRectangle(patch.edges, board, *center, turned);
        if (fit) fits.push_back(*fit);
      }
      if (fits.empty()) return std::nullopt;
      patch.fit = fits[MostUpright(fits, board)];
    }
    patch.agreement = AgreementOf(scan_, patch, board);
    return patch;
  }

  PlaneSearch PlaneSearchOf() const {
    return {.threshold_m = std::max(kMinThreshold_m, kPlaneSigmas * scan_.range_sigma_m()),
            .iterations = 60,
            .smallest_share = 0.25};
  }

  HoledEdges EdgesOf(const Board& board, const LidarPlane& plane,
                     const std::vector<std::size_t>& on_plane) const {
    const EdgeOptions options{.hollow = board.hole || !board.round_holes.empty(),
                              .correct = options_.correct_edges,
                              .beam = options_.beam};
    if (!board.round_holes.empty()) {
      return FindHoledEdges(scan_, plane, on_plane, board, options);
    }
    return {.edges = FindEdgePoints(scan_, plane, on_plane, options)};
  }

  int RingsOf(const std::vector<std::size_t>& places) const {
    int rings = 0;
    int ring = 0;
    int last = -1;
    for (const std::size_t place : places) {
      while (place >= scan_.first(ring + 1)) ++ring;
      rings += ring != last ? 1 : 0;
      last = ring;
    }
    return rings;
  }

  const ScanRings& scan_;
  std::span<const Board> boards_;
  const BoardSearchOptions& options_;
  Random random_;
  BoardSearch search_;
  std::vector<PatchProposal> proposals_;
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
