// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/board_agreement.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace sextant {
namespace {

constexpr double kBand_m = 0.08;  // Width of the band around the board in which its plane must end.
constexpr std::size_t kParts = 4;  // Parts of each side, judged separately.
constexpr double kMinFilled = 0.9;
constexpr double kMaxContinued =
    0.2;                            // Furniture of the board's width continues along a side: 0.25.
constexpr double kMaxClosed = 0.7;  // Share of one side.
constexpr double kMainPart = 0.5;
constexpr double kThreeSides = 1.5;  // Sum of the visible fractions of three or four sides.
constexpr double kMinVisible = 0.5;
// Share of the edge points on the outline. Hands, cables and uneven ranges spoil many edge points
// of a real board; furniture that fits as well is not free on all sides.
constexpr double kMinShare = 0.8;
constexpr double kMinShareIfFree = 0.6;
constexpr double kPartlyFree = 2.5;  // Sum of the visible fractions of the four sides.
constexpr double kFree = 3.5;
constexpr double kMaxSizeError = 0.06;  // Real ranges make boards up to 4 % larger.
constexpr double kMaxRms = 2.8;         // In sigmas; a board of another size has more.
constexpr double kMinDensity = 0.3;
constexpr int kMinEdgePoints = 10;
constexpr int kMinEdgePointsOnMinRings = 12;  // With kMinRings, furniture has up to 11 by chance.
constexpr int kMinPointsOfBoard = 16;
constexpr double kMaxPlaneSigma = 0.12;  // Share of the shorter edge: more is no flat plate.
constexpr double kThroughCost = 4.0;
constexpr double kBeyondCost = 2.0;
constexpr int kMinRims = 3;
constexpr double kMaxInHoles = 0.02;  // Returns in round holes relative to those on the board.

// Distance of a point beyond the rectangle's nearest side; negative inside.
double Beyond(const Eigen::Vector2d& point, double width, double height) {
  return std::max(std::abs(point.x()) - 0.5 * width, std::abs(point.y()) - 0.5 * height);
}

// Where a ray meets the plane, relative to the outline of a placed board.
class Outline {
 public:
  Outline(const PlaneRays& rays, const RectangleFit& fit, const Board& board)
      : board_(board),
        center_(fit.center),
        to_board_(Eigen::Rotation2Dd(-fit.angle_rad)),
        margin_(0.015 + rays.azimuth_step_m) {
    // A side along the rings may end anywhere before the next ring.
    for (int side = 0; side < kCornersPerBoard; ++side) {
      const Eigen::Vector2d normal = to_board_.inverse() * Normal(side);
      const double along_ring = std::abs(normal.dot(rays.ring_direction));
      const double gap = std::abs(normal.dot(rays.to_next_ring));
      band_[static_cast<std::size_t>(side)] =
          kBand_m + gap * std::max(0.0, 1.0 - along_ring / kCrossing);
    }
  }

  Eigen::Vector2d ToBoard(const Eigen::Vector2d& in_plane) const {
    return to_board_ * (in_plane - center_);
  }

  bool IsInside(const Eigen::Vector2d& q) const {
    if (Beyond(q, board_.top_right_m, board_.right_bottom_m) >= -margin_) return false;
    if (std::ranges::any_of(board_.round_holes, [&](const RoundHole& hole) {
          return (q - hole.center_in_board_m).norm() < hole.radius_m + margin_;
        })) {
      return false;
    }
    return !board_.hole || Beyond(q - board_.hole->center_in_board_m, board_.hole->width_m,
                                  board_.hole->height_m) >= margin_;
  }

  // Whether a point lies in a round hole, not at its rim.
  bool IsInHole(const Eigen::Vector2d& q) const {
    return std::ranges::any_of(board_.round_holes, [&](const RoundHole& hole) {
      return (q - hole.center_in_board_m).norm() < kHoleShare * hole.radius_m - margin_;
    });
  }

  // A quarter of a side, and whether a point lies in the band beyond it.
  struct Part {
    std::size_t side = 0;
    std::size_t part = 0;
  };
  std::optional<Part> BeyondSide(const Eigen::Vector2d& q) const {
    const Part part = PartAt(q);
    const double beyond = Beyond(q, board_.top_right_m, board_.right_bottom_m);
    if (beyond <= margin_ || beyond >= margin_ + band_[part.side]) return std::nullopt;
    return part;
  }

  // The nearest part of the outline.
  Part PartAt(const Eigen::Vector2d& q) const {
    const Eigen::Vector2d half(0.5 * board_.top_right_m, 0.5 * board_.right_bottom_m);
    const bool is_x = std::abs(q.x()) - half.x() > std::abs(q.y()) - half.y();
    Part part;
    part.side = is_x ? (q.x() > 0.0 ? 1U : 3U) : (q.y() > 0.0 ? 2U : 0U);
    const double along = is_x ? q.y() / half.y() : q.x() / half.x();
    const double place = 0.5 * (along + 1.0) * static_cast<double>(kParts);
    part.part = static_cast<std::size_t>(std::clamp(place, 0.0, kParts - 1.0));
    return part;
  }

  double margin() const { return margin_; }

 private:
  static constexpr double kCrossing = 0.3;    // Sine at which rings cross a side well.
  static constexpr double kHoleShare = 0.85;  // Spots at a hole's rim make it smaller.

  static Eigen::Vector2d Normal(int side) {
    return side % 2 == 0 ? Eigen::Vector2d::UnitY() : Eigen::Vector2d::UnitX();
  }

  const Board& board_;
  Eigen::Vector2d center_;
  Eigen::Rotation2Dd to_board_;
  double margin_;
  std::array<double, kCornersPerBoard> band_{};
};

// What rays show beyond each part of the outline.
struct OutlineCounts {
  std::array<std::array<int, kParts>, kCornersPerBoard> passing{};
  std::array<std::array<int, kParts>, kCornersPerBoard> ending{};

  void State(const Board& board, BoardAgreement& agreement) const {
    double known = 0.0;
    double closed = 0.0;
    for (std::size_t side = 0; side < passing.size(); ++side) {
      int open_parts = 0;
      int closed_parts = 0;
      for (std::size_t part = 0; part < kParts; ++part) {
        if (passing[side][part] + ending[side][part] == 0) continue;
        ++(ending[side][part] > passing[side][part] ? closed_parts : open_parts);
      }
      agreement.open[side] = static_cast<double>(open_parts) / kParts;
      agreement.closed[side] = static_cast<double>(closed_parts) / kParts;
      known += board.EdgeLengths()[side] * (open_parts + closed_parts);
      closed += board.EdgeLengths()[side] * closed_parts;
    }
    agreement.continued = known > 0.0 ? closed / known : 0.0;
  }
};

// Returns on the board relative to those that the sensor's steps lead to expect on its visible,
// crossed part.
double DensityOf(const ScanRings& scan, const BoardPatch& patch, const Board& board, int hit) {
  const Eigen::Vector3d center = patch.plane.At(patch.fit.center);
  double solid = board.top_right_m * board.right_bottom_m;
  if (board.hole) solid -= board.hole->width_m * board.hole->height_m;
  for (const RoundHole& hole : board.round_holes) {
    solid -= std::numbers::pi * hole.radius_m * hole.radius_m;
  }
  const Eigen::Vector3d toward = center.normalized();
  const double level = std::sqrt(std::max(1e-6, 1.0 - std::pow(scan.axis().dot(toward), 2)));
  const double solid_angle =
      solid * std::abs(patch.plane.normal.dot(toward)) / center.squaredNorm();
  return hit * level * scan.azimuth_step_rad() * scan.elevation_step_rad() / solid_angle;
}

double OpenSum(const BoardAgreement& agreement) {
  return std::accumulate(agreement.open.begin(), agreement.open.end(), 0.0);
}

// Whether free space beyond its sides delimits the board: most of two opposite sides, or three
// sides.
bool IsBounded(const BoardAgreement& agreement) {
  const std::array<double, kCornersPerBoard>& open = agreement.open;
  const auto mostly = [&](std::size_t side) { return open[side] >= kMainPart; };
  if ((mostly(0) && mostly(2)) || (mostly(1) && mostly(3))) return true;
  return std::ranges::count(open, 0.0) <= 1 && OpenSum(agreement) >= kThreeSides;
}

// Round holes at their known places identify a board, however little of its outline is seen.
bool IsKnownByHoles(const BoardPatch& patch) { return patch.fit.rims_seen >= kMinRims; }

double MinShare(const BoardAgreement& agreement) {
  const double free = (OpenSum(agreement) - kPartlyFree) / (kFree - kPartlyFree);
  return std::lerp(kMinShare, kMinShareIfFree, std::clamp(free, 0.0, 1.0));
}

}  // namespace

double BeyondBoard(const RectangleFit& fit, const Board& board, const Eigen::Vector2d& in_plane) {
  const Eigen::Vector2d in_board = Eigen::Rotation2Dd(-fit.angle_rad) * (in_plane - fit.center);
  return Beyond(in_board, board.top_right_m, board.right_bottom_m);
}

BoardAgreement AgreementOf(const ScanRings& scan, const PlaneRays& rays, const BoardPatch& patch,
                           const Board& board) {
  BoardAgreement agreement;
  const Outline outline(rays, patch.fit, board);
  OutlineCounts counts;
  int hit = 0;
  int through = 0;
  int hidden = 0;
  int last_ring = -1;
  for (const PlaneRay& ray : rays.rays) {
    const Eigen::Vector2d q = outline.ToBoard(ray.at);
    if (outline.IsInside(q)) {
      if (ray.end == RayEnd::kOnPlane) {
        ++hit;
        agreement.rings += ray.ring != last_ring ? 1 : 0;
        last_ring = ray.ring;
      } else {
        ++(ray.end == RayEnd::kBehind ? through : hidden);
      }
    } else if (outline.IsInHole(q)) {
      agreement.in_holes += ray.end == RayEnd::kOnPlane ? 1 : 0;
    } else if (const auto part = outline.BeyondSide(q); part && ray.end != RayEnd::kInFront) {
      auto& sides = ray.end == RayEnd::kBehind ? counts.passing : counts.ending;
      ++sides[part->side][part->part];
    }
  }
  // A ring that ends at a side shows free space beyond it, even without a return from there.
  for (std::size_t i = 0; i < patch.edges.size(); ++i) {
    if (patch.fit.sides[i] < 0 || patch.fit.sides[i] >= kCornersPerBoard) continue;
    const auto part = outline.PartAt(outline.ToBoard(patch.edges[i].in_plane));
    ++counts.passing[part.side][part.part];
  }
  counts.State(board, agreement);
  agreement.points = hit;
  agreement.filled = hit > 0 ? static_cast<double>(hit) / (hit + through) : 0.0;
  agreement.visible = 1.0 - static_cast<double>(hidden) / std::max(1, hit + through + hidden);
  agreement.density = DensityOf(scan, patch, board, hit);
  return agreement;
}

BoardAgreement AgreementOf(const ScanRings& scan, const BoardPatch& patch, const Board& board) {
  const double reach = std::hypot(board.top_right_m, board.right_bottom_m);
  return AgreementOf(scan, RaysAround(scan, patch.plane, patch.fit.center, reach), patch, board);
}

double RayCost(const PlaneRays& rays, const RectangleFit& fit, const Board& board) {
  const Outline outline(rays, fit, board);
  double cost = 0.0;
  for (const PlaneRay& ray : rays.rays) {
    if (ray.end == RayEnd::kInFront) continue;
    const Eigen::Vector2d q = outline.ToBoard(ray.at);
    const bool on_plane = ray.end == RayEnd::kOnPlane;
    if (outline.IsInside(q)) {
      cost += on_plane ? -1.0 : kThroughCost;
    } else if (on_plane && outline.IsInHole(q)) {
      cost += kThroughCost;
    } else if (on_plane && outline.BeyondSide(q)) {
      cost += kBeyondCost;
    }
  }
  return cost;
}

std::optional<std::string> RejectionReason(const BoardPatch& patch, const Board& board) {
  const BoardAgreement& agreement = patch.agreement;
  if (agreement.rings < kMinRings) {
    return fmt::format(
        "only {} rings cross it, {} are needed: move it closer or use a sensor with more rings",
        agreement.rings, kMinRings);
  }
  const int min_edge_points =
      agreement.rings == kMinRings ? kMinEdgePointsOnMinRings : kMinEdgePoints;
  if (static_cast<int>(patch.edges.size()) < min_edge_points) {
    return fmt::format("only {} edge points on {} rings, {} are needed", patch.edges.size(),
                       agreement.rings, min_edge_points);
  }
  if (agreement.points < kMinPointsOfBoard) {
    return fmt::format("only {} returns on it, {} are needed", agreement.points, kMinPointsOfBoard);
  }
  const double max_sigma_m = kMaxPlaneSigma * std::min(board.top_right_m, board.right_bottom_m);
  if (patch.plane.sigma_m > max_sigma_m) {
    return fmt::format(
        "its returns are {:.0f} mm off a plane (1 sigma), a plate of its size at most {:.0f} mm",
        1e3 * patch.plane.sigma_m, 1e3 * max_sigma_m);
  }
  if (agreement.density < kMinDensity) {
    return fmt::format("only {:.0f} % of the returns expected from a board there",
                       100.0 * agreement.density);
  }
  if (patch.fit.share < MinShare(agreement) || patch.fit.rms > kMaxRms ||
      std::abs(patch.fit.size_ratio - 1.0) > kMaxSizeError) {
    return fmt::format(
        "its outline is not {:.3f} x {:.3f} m: {:.0f} % of the edge points fit, {:.1f} sigma rms, "
        "{:+.0f} % in size",
        board.top_right_m, board.right_bottom_m, 100.0 * patch.fit.share, patch.fit.rms,
        100.0 * (patch.fit.size_ratio - 1.0));
  }
  if (agreement.in_holes > kMaxInHoles * agreement.points) {
    return fmt::format("{} returns are where the board has round holes", agreement.in_holes);
  }
  const auto holes = static_cast<int>(board.round_holes.size());
  if (2 * patch.fit.rims_seen < holes) {
    return fmt::format("{} of its {} round holes are seen, half of them are needed",
                       patch.fit.rims_seen, holes);
  }
  if (!IsBounded(agreement) && !IsKnownByHoles(patch)) {
    const auto open = std::ranges::count_if(agreement.open, [](double part) { return part > 0.0; });
    return fmt::format(
        "its ends are visible at {} of its sides only, not far enough along two opposite ones or "
        "three",
        open);
  }
  if (agreement.filled < kMinFilled) {
    return fmt::format("{:.0f} % of the rays pass through it", 100.0 * (1.0 - agreement.filled));
  }
  if (agreement.visible < kMinVisible) {
    return fmt::format("a nearer object hides {:.0f} % of it", 100.0 * (1.0 - agreement.visible));
  }
  const double most_closed = *std::ranges::max_element(agreement.closed);
  if (!IsKnownByHoles(patch) && (agreement.continued > kMaxContinued || most_closed > kMaxClosed)) {
    return fmt::format(
        "its plane continues beyond {:.0f} % of its outline, as that of a wall or of furniture "
        "does",
        100.0 * agreement.continued);
  }
  return std::nullopt;
}

}  // namespace sextant
