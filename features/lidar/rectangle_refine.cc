// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rectangle_refine.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "features/lidar/rectangle_starts.h"
#include "geometry/board_check.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr double kHuber = 2.0;      // In sigmas; a uniform error stays within 1.73.
constexpr double kOutlier = 4.0;    // In sigmas.
constexpr double kMaxSigma = 0.15;  // Position, relative to half the diagonal.
constexpr int kMinCrossing = 3;     // Ends of rings on the sides of an axis that determine it.
constexpr double kMinCrossingSine =
    0.12;  // Sine of the angle between a ring and a side that it crosses.
constexpr int kMinCrossingOfFew = 2;  // A single end may be that of another side.
// Standard deviation of the growth, in spots, at a side that rings meet slantwise or not at all:
// successive returns then have ever less of their spot on the board, and mix with what is behind,
// so that the side appears further in instead of further out.
constexpr double kSlantGrowthSigma = 0.4;
constexpr double kSlantSine = 0.3;
constexpr double kMinVariance_m2 = 1e-6;      // A position within an interval.
constexpr std::size_t kMaxSides = kFirstRim;  // Straight ones.
constexpr std::size_t kRimParts = 4;          // Parts of a rim, to count how much of it is seen.
constexpr std::size_t kMinRimParts = 3;
constexpr int kMinRimPoints = 4;
// Prior sigma of the distance of all sides beyond where the board's size has them, relative to half
// the mean side: boards are measured to that, and ranges are off by as much.
constexpr double kExcessSigma = 0.01;

// Outward normals of the sides 0 to 3 in the board's frame: y = -h/2 is the first.
const std::array<Eigen::Vector2d, 4> kNormals = {Eigen::Vector2d(0, -1), Eigen::Vector2d(1, 0),
                                                 Eigen::Vector2d(0, 1), Eigen::Vector2d(-1, 0)};

struct SidePlace {
  int side = -1;
  double distance = 0.0;                            // Signed, positive outside the side [m].
  Eigen::Vector2d grown = Eigen::Vector2d::Zero();  // Displacement of the edge by the beam [m].
  double sigma = 1.0;                               // [m].
  double half_step = 0.0;                           // Across the side [m].
  // Position along the side, from its middle [m]; on a rim, the direction from its centre [rad].
  double along = 0.0;
  double excess = 0.0;        // Subtracted from the distance [m].
  double growth_sigma = 0.0;  // Signed as the distance, common to all edges [m].
  Eigen::Vector4d by_pose = Eigen::Vector4d::Zero();  // Derivative by the placement.
};

// Sums over the edge points that belong to a side.
struct Sums {
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  Eigen::Vector3d by_growth = Eigen::Vector3d::Zero();
  std::array<SharedStep, kMaxSides> shared{};
  std::array<SharedSlope, kMaxSides> slopes{};
  std::array<Eigen::Vector3d, kMaxSides> by_side{};   // For an offset of all points of a side.
  std::array<Eigen::Vector3d, kMaxSides> by_slope{};  // For a slope of them.
  std::array<int, kMaxSides> of_side{};
  std::vector<std::array<int, kRimParts>> rims{};
  double by_size = 0.0;
  double size_weight = 0.0;
  double chi2 = 0.0;
  double squares = 0.0;
  int used = 0;

  Sums() {
    by_side.fill(Eigen::Vector3d::Zero());
    by_slope.fill(Eigen::Vector3d::Zero());
  }

  void Add(const SidePlace& place, const Eigen::Vector2d& half) {
    const auto side = static_cast<std::size_t>(place.side);
    const Eigen::Vector4d of_all = place.by_pose / place.sigma;
    const Eigen::Vector3d j = of_all.head<3>();
    information += of_all * of_all.transpose();
    by_growth += j * place.growth_sigma / place.sigma;
    chi2 += place.distance * place.distance / (place.sigma * place.sigma);
    if (side >= kMaxSides) return;
    shared[side].Add(place.distance, place.half_step);
    slopes[side].Add(place.along, place.distance, place.half_step);
    by_side[side] += j / place.sigma;
    by_slope[side] += j * place.along / place.sigma;
    if (place.side < kCornersPerBoard) {
      const double arm = (place.side % 2 == 0 ? half.y() : half.x()) / place.sigma;
      by_size += arm * (place.distance + place.excess) / place.sigma;
      size_weight += arm * arm;
    }
  }

  // Counts an edge point, whether or not it determines the position.
  void Count(const SidePlace& place) {
    if (place.side < kFirstRim) {
      ++of_side[static_cast<std::size_t>(place.side)];
    } else {
      CountOnRim(place);
    }
    squares += place.distance * place.distance;
    ++used;
  }

  void CountOnRim(const SidePlace& place) {
    const auto rim = static_cast<std::size_t>(place.side - kFirstRim);
    if (rim >= rims.size()) rims.resize(rim + 1);
    const double turn = 0.5 * (place.along / std::numbers::pi + 1.0);
    ++rims[rim][static_cast<std::size_t>(turn * kRimParts) % kRimParts];
  }

  int RimsSeen() const {
    return static_cast<int>(std::ranges::count_if(rims, [](const auto& parts) {
      const auto empty = static_cast<std::size_t>(std::ranges::count(parts, 0));
      return kRimParts - empty >= kMinRimParts &&
             std::accumulate(parts.begin(), parts.end(), 0) >= kMinRimPoints;
    }));
  }

  // A prior of four residuals of one sigma keeps the scale from vanishing for few residuals. A
  // single point of a side states its whole step in its own sigma.
  Eigen::Matrix3d Covariance(const Eigen::Matrix3d& of_intervals, double excess_sigma) const {
    constexpr double kPrior = 4.0;
    const double scale = (chi2 + kPrior) / (std::max(used, 3) - 3 + kPrior);
    const Eigen::Matrix3d inverse =
        (OfPose(scale * excess_sigma * excess_sigma) / scale + of_intervals).inverse();
    const Eigen::Vector3d by_all = inverse * by_growth / scale;  // Zero if opposite sides cancel.
    Eigen::Matrix3d covariance = inverse + by_all * by_all.transpose();
    for (std::size_t side = 0; side < kMaxSides; ++side) {
      if (of_side[side] < 2) continue;
      const Eigen::Vector3d by_offset = inverse * by_side[side] / scale;
      covariance += shared[side].Variance() * by_offset * by_offset.transpose();
      const Eigen::Vector3d by_tilt = inverse * by_slope[side] / scale;
      covariance += slopes[side].Variance() * by_tilt * by_tilt.transpose();
    }
    return covariance;
  }

  // The information on center and angle where the excess is unknown but for a prior.
  Eigen::Matrix3d OfPose(double excess_variance) const {
    const Eigen::Vector3d common = information.topRightCorner<3, 1>();
    return information.topLeftCorner<3, 3>() -
           common * common.transpose() / (information(3, 3) + 1.0 / excess_variance);
  }

  int SidesSeen() const {
    return static_cast<int>(std::count_if(of_side.begin(), of_side.begin() + kCornersPerBoard,
                                          [](int count) { return count > 0; }));
  }
};

// The displacements along one axis of the board at which all returns lie on it and the rings beyond
// do not.
struct AxisInterval {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  // Spots at the ends before the rings beyond, in both directions [m].
  std::array<double, 2> end_spots{};

  // The growth at two opposite ends cancels.
  double GrowthVariance() const {
    const double spot = end_spots[0] - end_spots[1];
    return kSlantGrowthSigma * kSlantGrowthSigma * spot * spot;
  }

  double Middle() const { return 0.5 * (low + high); }
  double Variance() const {
    const double length = std::max(high - low, 0.0);
    return length * length / 12.0;
  }
};

class Fitter {
 public:
  Fitter(std::span<const EdgePoint> edges, const Board& board)
      : edges_(edges),
        board_(board),
        half_(0.5 * board.top_right_m, 0.5 * board.right_bottom_m),
        excess_sigma_(kExcessSigma * half_.mean()) {}

  // `turn` is the rotation by the pose's angle.
  SidePlace Place(const EdgePoint& edge, const RectanglePlacement& pose,
                  const Eigen::Matrix2d& turn) const {
    const Eigen::Vector2d in_board = turn.transpose() * (edge.in_plane - pose.head<2>());
    const Eigen::Vector2d out = turn.transpose() * edge.outward;
    const bool inner = edge.inner && board_.hole;
    if (edge.inner && !board_.round_holes.empty()) {
      const SidePlace place = PlaceOnRim(edge, in_board, out, turn, pose(3));
      if (!board_.hole || std::abs(place.distance) < kOutlier * place.sigma) return place;
    }
    const Eigen::Vector2d offset =
        inner ? board_.hole->center_in_board_m : Eigen::Vector2d(Eigen::Vector2d::Zero());
    const Eigen::Vector2d half =
        inner ? Eigen::Vector2d(0.5 * board_.hole->width_m, 0.5 * board_.hole->height_m) : half_;
    const Eigen::Vector2d q = in_board - offset;
    const int side = inner ? LeftSide(q, -out, half) : LeftSide(q, out, half);
    const Eigen::Vector2d& normal = kNormals[static_cast<std::size_t>(side)];
    SidePlace place;
    place.side = inner ? side + kCornersPerBoard : side;
    const Eigen::Vector2d normal_in_plane = turn * normal;
    const double outward = inner ? -1.0 : 1.0;  // Growth makes the opening smaller.
    place.excess = inner ? 0.0 : pose(3);
    const double growth = outward * edge.Growth(normal_in_plane);
    place.grown = growth * normal_in_plane;
    place.distance = normal.dot(q) - normal.cwiseAbs().dot(half) - growth - place.excess;
    place.sigma = std::sqrt(edge.VarianceAcross(normal_in_plane) + 1e-12);
    place.along = normal.x() * q.y() - normal.y() * q.x();
    place.half_step = 0.5 * std::abs(normal.dot(out)) * edge.step_m;
    const bool slant = edge.across || std::abs(normal.dot(out)) < kSlantSine;
    place.growth_sigma = outward * edge.SpotAcross(normal_in_plane) *
                         (slant ? kSlantGrowthSigma : edge.beam.growth_sigma);
    place.by_pose << -normal_in_plane, normal.x() * in_board.y() - normal.y() * in_board.x(),
        inner ? 0.0 : -1.0;
    return place;
  }

  // On the nearest rim.
  SidePlace PlaceOnRim(const EdgePoint& edge, const Eigen::Vector2d& in_board,
                       const Eigen::Vector2d& out, const Eigen::Matrix2d& turn,
                       double excess) const {
    const auto distance = [&](const RoundHole& hole) {
      return std::abs((in_board - hole.center_in_board_m).norm() - hole.radius_m);
    };
    const auto nearest = std::ranges::min_element(board_.round_holes, {}, distance);
    const Eigen::Vector2d arm = in_board - nearest->center_in_board_m;
    const double from = std::max(arm.norm(), 1e-9);
    const Eigen::Vector2d normal = -arm / from;  // Off the material: towards the centre.
    const Eigen::Vector2d normal_in_plane = turn * normal;
    const double growth = edge.Growth(normal_in_plane);
    SidePlace place;
    place.side = kFirstRim + static_cast<int>(nearest - board_.round_holes.begin());
    place.excess = excess;
    place.grown = growth * normal_in_plane;
    place.distance = nearest->radius_m - from - growth - excess;
    place.sigma = std::sqrt(edge.VarianceAcross(normal_in_plane) + 1e-12);
    place.along = std::atan2(arm.y(), arm.x());
    place.half_step = 0.5 * std::abs(normal.dot(out)) * edge.step_m;
    place.growth_sigma = edge.beam.growth_sigma * edge.SpotAcross(normal_in_plane);
    place.by_pose << -normal_in_plane, normal.x() * in_board.y() - normal.y() * in_board.x(), -1.0;
    return place;
  }

  // The sum of Huber's loss over the edges, truncated at `reach`, and the step that reduces it.
  double Step(const RectanglePlacement& pose, double reach, RectanglePlacement& step) const {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
    const double prior = 1.0 / (excess_sigma_ * excess_sigma_);
    normal(3, 3) = prior;
    gradient(3) = prior * pose(3);
    double cost = prior * pose(3) * pose(3);
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(pose.z()).toRotationMatrix();
    for (const EdgePoint& edge : edges_) {
      const SidePlace place = Place(edge, pose, turn);
      const double r = place.distance / place.sigma;
      const double size = std::min(std::abs(r), reach);
      const double weight = size <= kHuber ? 1.0 : kHuber / size;
      cost += size <= kHuber ? r * r : kHuber * (2.0 * size - kHuber);
      if (size == reach) continue;
      const Eigen::Vector4d j = place.by_pose / place.sigma;
      normal += weight * j * j.transpose();
      gradient += weight * j * r;
    }
    // The excess is eliminated. Slight damping: an initial pose may leave a direction undetermined
    // that the solution does not.
    const Eigen::Vector3d common = normal.topRightCorner<3, 1>() / normal(3, 3);
    Eigen::Matrix3d of_pose =
        normal.topLeftCorner<3, 3>() - normal(3, 3) * common * common.transpose();
    of_pose.diagonal() *= 1.0 + 1e-6;
    of_pose.diagonal().array() += 1e-3;
    step.head<3>() =
        -SolveSymmetric<3>(of_pose, Eigen::Vector3d(gradient.head<3>() - common * gradient(3)));
    step(3) = -gradient(3) / normal(3, 3) - common.dot(step.head<3>());
    return cost;
  }

  std::optional<RectangleFit> Finish(RectanglePlacement pose) const {
    RectangleFit fit;
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(pose.z()).toRotationMatrix();
    // Along an axis whose sides no ring crosses.
    std::array<bool, 2> bracketed{};
    Eigen::Matrix3d of_intervals = Eigen::Matrix3d::Zero();
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const AxisInterval interval = IntervalAlong(axis, pose, turn);
      if (!std::isfinite(interval.Variance())) continue;
      const CrossedSides crossed = CrossedAlong(axis, pose, turn);
      if (crossed.ends >= kMinCrossing) continue;
      if (crossed.ends >= kMinCrossingOfFew && crossed.information * interval.Variance() > 1.0) {
        continue;
      }
      bracketed[static_cast<std::size_t>(axis)] = true;
      pose.head<2>() += turn.col(axis) * interval.Middle();
      const Eigen::Vector3d along(turn(0, axis), turn(1, axis), 0.0);
      of_intervals += along * along.transpose() /
                      (interval.Variance() + interval.GrowthVariance() + kMinVariance_m2);
    }
    Sums sums;
    for (const EdgePoint& edge : edges_) {
      const SidePlace place = Place(edge, pose, turn);
      const bool belongs = std::abs(place.distance) <= kOutlier * place.sigma;
      fit.sides.push_back(belongs ? place.side : -1);
      fit.sigmas_m.push_back(place.sigma);
      fit.on_edge.push_back(edge.in_plane - place.grown);
      if (!belongs) continue;
      sums.Count(place);
      if (place.side >= kFirstRim || !bracketed[AxisOf(place.side)]) sums.Add(place, half_);
    }
    if (sums.used < kMinEdgesOfFit) return std::nullopt;
    // Angles are scaled by the board's half diagonal, to make both kinds of unknowns comparable.
    const Eigen::Vector3d scale(1.0, 1.0, 1.0 / half_.norm());
    const Eigen::Matrix3d scaled = scale.asDiagonal() *
                                   (sums.OfPose(excess_sigma_ * excess_sigma_) + of_intervals) *
                                   scale.asDiagonal();
    const double least = EigenOf(scaled).values(0);
    if (least * std::pow(kMaxSigma * half_.norm(), 2) < 1.0) return std::nullopt;
    fit.center = pose.head<2>();
    fit.angle_rad = UprightAngle(pose.z());
    const double turned = (fit.angle_rad - pose.z()) / (0.5 * std::numbers::pi);
    for (int& side : fit.sides) {
      side = SideAfterTurn(board_, side, static_cast<int>(std::lround(turned)));
    }
    fit.covariance = sums.Covariance(of_intervals, excess_sigma_);
    fit.rms = std::sqrt(sums.chi2 / sums.used);
    fit.rms_m = std::sqrt(sums.squares / sums.used);
    fit.share = static_cast<double>(sums.used) / static_cast<double>(edges_.size());
    fit.sides_seen = sums.SidesSeen();
    fit.rims_seen = sums.RimsSeen();
    fit.size_ratio = 1.0 + sums.by_size / std::max(sums.size_weight, 1e-12);
    return fit;
  }

  // The angle with corner 0 highest, among those at which the outline looks the same.
  double UprightAngle(double angle) const {
    const bool square = IsSquare(half_) && !board_.hole && board_.round_holes.empty();
    const double half_turn = HolesAllowTurns(board_, 2) ? 1.0 : 2.0;
    const double period = (square ? 0.5 : half_turn) * std::numbers::pi;
    const double corner_up = AngleWithCornerUp(board_);
    return corner_up + std::remainder(angle - corner_up, period);
  }

 private:
  static std::size_t AxisOf(int side) { return side % 2 == 0 ? 1 : 0; }

  // The rings that cross the sides of an axis, and the information on the position along it.
  struct CrossedSides {
    int ends = 0;
    double information = 0.0;  // [1/m^2]
  };

  CrossedSides CrossedAlong(Eigen::Index axis, const RectanglePlacement& pose,
                            const Eigen::Matrix2d& turn) const {
    CrossedSides crossed;
    for (const EdgePoint& edge : edges_) {
      const SidePlace place = Place(edge, pose, turn);
      const bool on_rim = place.side >= kFirstRim;
      if (edge.across) continue;
      if (!on_rim && AxisOf(place.side) != static_cast<std::size_t>(axis)) continue;
      if (std::abs(turn.col(axis).dot(edge.outward)) < kMinCrossingSine) continue;
      if (std::abs(place.distance) > kOutlier * place.sigma) continue;
      // A rim crosses every axis, at an angle.
      const double share = on_rim ? turn.col(axis).dot(place.by_pose.head<2>()) : 1.0;
      ++crossed.ends;
      crossed.information += share * share / (place.sigma * place.sigma);
    }
    return crossed;
  }

  AxisInterval IntervalAlong(Eigen::Index axis, const RectanglePlacement& pose,
                             const Eigen::Matrix2d& turn) const {
    AxisInterval interval;
    for (const EdgePoint& edge : edges_) {
      const SidePlace place = Place(edge, pose, turn);
      if (edge.inner || std::abs(place.distance) > kOutlier * place.sigma) continue;
      const Eigen::Vector2d normal = turn.col(axis);
      const double growth = edge.Growth(normal);
      const double step = normal.dot(edge.outward) * edge.step_m;
      const double middle = normal.dot(edge.in_plane - pose.head<2>());
      const double on = middle - 0.5 * step;
      interval.low = std::max(interval.low, on - half_(axis) - growth);
      interval.high = std::min(interval.high, on + half_(axis) + growth);
      if (!edge.across || AxisOf(place.side) != static_cast<std::size_t>(axis)) continue;
      const double off = middle + 0.5 * step;
      interval.end_spots[step > 0.0 ? 0 : 1] = edge.SpotAcross(normal);
      if (step > 0.0) interval.high = std::min(interval.high, off - half_(axis) - growth);
      if (step < 0.0) interval.low = std::max(interval.low, off + half_(axis) + growth);
    }
    return interval;
  }

  // The side through which a line from q along `out` leaves the rectangle; along -`out`, the one
  // through which it enters.
  static int LeftSide(const Eigen::Vector2d& q, const Eigen::Vector2d& out,
                      const Eigen::Vector2d& half) {
    int side = 0;
    double soonest = std::numeric_limits<double>::max();
    for (int k = 0; k < kCornersPerBoard; ++k) {
      const Eigen::Vector2d& normal = kNormals[static_cast<std::size_t>(k)];
      const double along = normal.dot(out);
      if (along < 1e-9) continue;
      const double t = (normal.cwiseAbs().dot(half) - normal.dot(q)) / along;
      if (t < soonest) {
        soonest = t;
        side = k;
      }
    }
    return side;
  }

  std::span<const EdgePoint> edges_;
  const Board& board_;
  Eigen::Vector2d half_;
  double excess_sigma_;
};

}  // namespace

double ImprovePlacement(std::span<const EdgePoint> edges, const Board& board, int iterations,
                        double reach, RectanglePlacement& placement) {
  const Fitter fitter(edges, board);
  RectanglePlacement step;
  for (int i = 0; i < iterations; ++i) {
    fitter.Step(placement, reach, step);
    placement += step;
    if (step.norm() < 1e-7) break;
  }
  return fitter.Step(placement, kReachOfFit, step);
}

std::optional<RectangleFit> FinishPlacement(std::span<const EdgePoint> edges, const Board& board,
                                            const RectanglePlacement& placement, double cost) {
  std::optional<RectangleFit> fit = Fitter(edges, board).Finish(placement);
  if (fit) fit->cost = cost;
  return fit;
}

double AngleWithCornerUp(const Board& board) {
  return std::numbers::pi / 2.0 - std::atan2(board.right_bottom_m, board.top_right_m);
}

}  // namespace sextant
