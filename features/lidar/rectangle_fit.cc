// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rectangle_fit.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr double kHuber = 2.0;    // In sigmas; a uniform error stays within 1.73.
constexpr double kOutlier = 4.0;  // In sigmas.
constexpr int kIterations = 12;
constexpr int kStarts = 10;
constexpr int kFirstIterations = 3;
constexpr int kFinalists = 3;
// Sigmas beyond which an edge point is ignored: at first no point, finally those of hands or
// stands.
constexpr double kFirstReach = 1e9;
constexpr double kReach = 8.0;
constexpr double kOversize = 1.15;  // Extent of the edge points relative to the board's.
constexpr double kAngleSlack_rad = 0.02;
constexpr int kMinEdges = 4;
constexpr std::size_t kMaxSides = 8;  // For a hollow board.

// Outward normals of the sides 0 to 3 in the board's frame: y = -h/2 is the first.
const std::array<Eigen::Vector2d, 4> kNormals = {Eigen::Vector2d(0, -1), Eigen::Vector2d(1, 0),
                                                 Eigen::Vector2d(0, 1), Eigen::Vector2d(-1, 0)};

struct SidePlace {
  int side = -1;
  double distance = 0.0;                            // Signed, positive outside the side [m].
  Eigen::Vector2d grown = Eigen::Vector2d::Zero();  // Displacement of the edge by the beam [m].
  double sigma = 1.0;                               // [m].
  double half_step = 0.0;                           // Across the side [m].
  double growth_sigma = 0.0;  // Signed as the distance, common to all edges [m].
  Eigen::Vector3d by_pose = Eigen::Vector3d::Zero();  // Derivative by (center, angle).
};

// Sums over the edge points that belong to a side.
struct Sums {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d by_growth = Eigen::Vector3d::Zero();
  std::array<SharedStep, kMaxSides> shared{};
  std::array<Eigen::Vector3d, kMaxSides> by_side{};  // For an offset of all points of a side.
  std::array<int, kMaxSides> of_side{};
  double by_size = 0.0;
  double size_weight = 0.0;
  double chi2 = 0.0;
  double squares = 0.0;
  int used = 0;

  Sums() { by_side.fill(Eigen::Vector3d::Zero()); }

  void Add(const SidePlace& place, const Eigen::Vector2d& half) {
    const auto side = static_cast<std::size_t>(place.side);
    const Eigen::Vector3d j = place.by_pose / place.sigma;
    information += j * j.transpose();
    by_growth += j * place.growth_sigma / place.sigma;
    shared[side].Add(place.distance, place.half_step);
    by_side[side] += j / place.sigma;
    ++of_side[side];
    if (place.side < kCornersPerBoard) {
      const double arm = (place.side % 2 == 0 ? half.y() : half.x()) / place.sigma;
      by_size += arm * place.distance / place.sigma;
      size_weight += arm * arm;
    }
    chi2 += place.distance * place.distance / (place.sigma * place.sigma);
    squares += place.distance * place.distance;
    ++used;
  }

  // A prior of four residuals of one sigma keeps the scale from vanishing for few residuals.
  Eigen::Matrix3d Covariance() const {
    constexpr double kPrior = 4.0;
    const Eigen::Matrix3d inverse = information.inverse();
    const Eigen::Vector3d by_all = inverse * by_growth;  // Zero if opposite sides cancel.
    Eigen::Matrix3d covariance =
        (chi2 + kPrior) / (used - 3 + kPrior) * inverse + by_all * by_all.transpose();
    for (std::size_t side = 0; side < kMaxSides; ++side) {
      const Eigen::Vector3d by_offset = inverse * by_side[side];
      covariance += shared[side].Variance() * by_offset * by_offset.transpose();
    }
    return covariance;
  }

  int SidesSeen() const {
    return static_cast<int>(std::count_if(of_side.begin(), of_side.begin() + kCornersPerBoard,
                                          [](int count) { return count > 0; }));
  }
};

class Fitter {
 public:
  Fitter(std::span<const EdgePoint> edges, const Board& board)
      : edges_(edges), board_(board), half_(0.5 * board.top_right_m, 0.5 * board.right_bottom_m) {}

  // Initial poses: the middle of the edge points and, if they extend further than the board, the
  // poses flush with either end.
  void AddStarts(double angle, std::vector<Eigen::Vector3d>& starts) const {
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
    Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
    Eigen::Vector2d high = -low;
    for (const EdgePoint& edge : edges_) {
      const Eigen::Vector2d q = turn.transpose() * edge.in_plane;
      low = low.cwiseMin(q);
      high = high.cwiseMax(q);
    }
    const auto places = [&](Eigen::Index axis) {
      std::vector<double> middles = {0.5 * (low(axis) + high(axis))};
      if (high(axis) - low(axis) > kOversize * 2.0 * half_(axis)) {
        middles.insert(middles.end(), {low(axis) + half_(axis), high(axis) - half_(axis)});
      }
      return middles;
    };
    for (const double x : places(0)) {
      for (const double y : places(1)) {
        const Eigen::Vector2d center = turn * Eigen::Vector2d(x, y);
        starts.emplace_back(center.x(), center.y(), angle);
      }
    }
  }

  // `turn` is the rotation by the pose's angle.
  SidePlace Place(const EdgePoint& edge, const Eigen::Vector3d& pose,
                  const Eigen::Matrix2d& turn) const {
    const Eigen::Vector2d in_board = turn.transpose() * (edge.in_plane - pose.head<2>());
    const Eigen::Vector2d out = turn.transpose() * edge.outward;
    const bool inner = edge.inner && board_.hole;
    const Eigen::Vector2d offset =
        inner ? board_.hole->center_in_board_m : Eigen::Vector2d(Eigen::Vector2d::Zero());
    const Eigen::Vector2d half =
        inner ? Eigen::Vector2d(0.5 * board_.hole->width_m, 0.5 * board_.hole->height_m) : half_;
    const Eigen::Vector2d q = in_board - offset;
    const int side = inner ? EnteredSide(q, out, half) : LeftSide(q, out, half);
    const Eigen::Vector2d& normal = kNormals[static_cast<std::size_t>(side)];
    SidePlace place;
    place.side = inner ? side + kCornersPerBoard : side;
    const Eigen::Vector2d normal_in_plane = turn * normal;
    const double outward = inner ? -1.0 : 1.0;  // Growth makes the opening smaller.
    place.distance =
        normal.dot(q) - normal.cwiseAbs().dot(half) - outward * edge.Growth(normal_in_plane);
    place.sigma = std::sqrt(edge.VarianceAcross(normal_in_plane) + 1e-12);
    place.half_step = 0.5 * std::abs(normal.dot(out)) * edge.step_m;
    place.growth_sigma = outward * edge.beam.growth_sigma * edge.SpotAcross(normal_in_plane);
    place.by_pose << -normal_in_plane, normal.x() * in_board.y() - normal.y() * in_board.x();
    return place;
  }

  // The sum of Huber's loss over the edges, truncated at `reach`, and the step that reduces it.
  double Step(const Eigen::Vector3d& pose, double reach, Eigen::Vector3d& step) const {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    double cost = 0.0;
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(pose.z()).toRotationMatrix();
    for (const EdgePoint& edge : edges_) {
      const SidePlace place = Place(edge, pose, turn);
      const double r = place.distance / place.sigma;
      const double size = std::min(std::abs(r), reach);
      const double weight = size <= kHuber ? 1.0 : kHuber / size;
      cost += size <= kHuber ? r * r : kHuber * (2.0 * size - kHuber);
      if (size == reach) continue;
      const Eigen::Vector3d j = place.by_pose / place.sigma;
      normal += weight * j * j.transpose();
      gradient += weight * j * r;
    }
    // Slight damping: an initial pose may leave a direction undetermined that the solution does
    // not.
    normal.diagonal() *= 1.0 + 1e-6;
    normal.diagonal().array() += 1e-3;
    step = -SolveSymmetric(normal, gradient);
    return cost;
  }

  std::optional<RectangleFit> Finish(const Eigen::Vector3d& pose) const {
    RectangleFit fit{.center = pose.head<2>(),
                     .angle_rad = pose.z(),
                     .covariance = Eigen::Matrix3d::Zero(),
                     .sides = {},
                     .sigmas_m = {},
                     .on_edge = {},
                     .rms = 0.0,
                     .rms_m = 0.0,
                     .share = 0.0,
                     .sides_seen = 0,
                     .size_ratio = 1.0};
    Sums sums;
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(pose.z()).toRotationMatrix();
    for (const EdgePoint& edge : edges_) {
      const SidePlace place = Place(edge, pose, turn);
      const bool belongs = std::abs(place.distance) <= kOutlier * place.sigma;
      fit.sides.push_back(belongs ? place.side : -1);
      fit.sigmas_m.push_back(place.sigma);
      fit.on_edge.push_back(edge.in_plane - place.grown);
      if (belongs) sums.Add(place, half_);
    }
    if (sums.used < kMinEdges) return std::nullopt;
    // Angles are scaled by the board's half diagonal, to make both kinds of unknowns comparable.
    Eigen::Vector3d scale(1.0, 1.0, 1.0 / half_.norm());
    const Eigen::Matrix3d scaled = scale.asDiagonal() * sums.information * scale.asDiagonal();
    const SymmetricEigen<3> eigen = EigenOf(scaled);
    if (eigen.values(0) < 1e-4 * eigen.values(2)) return std::nullopt;
    fit.covariance = sums.Covariance();
    fit.rms = std::sqrt(sums.chi2 / sums.used);
    fit.rms_m = std::sqrt(sums.squares / sums.used);
    fit.share = static_cast<double>(sums.used) / static_cast<double>(edges_.size());
    fit.sides_seen = sums.SidesSeen();
    fit.size_ratio = 1.0 + sums.by_size / std::max(sums.size_weight, 1e-12);
    return fit;
  }

 private:
  // The side through which a line from q along `out` leaves the rectangle.
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

  // The side through which such a line enters the rectangle.
  static int EnteredSide(const Eigen::Vector2d& q, const Eigen::Vector2d& out,
                         const Eigen::Vector2d& half) {
    int side = 0;
    double latest = std::numeric_limits<double>::lowest();
    for (int k = 0; k < kCornersPerBoard; ++k) {
      const Eigen::Vector2d& normal = kNormals[static_cast<std::size_t>(k)];
      const double along = normal.dot(out);
      if (along > -1e-9) continue;
      const double t = (normal.cwiseAbs().dot(half) - normal.dot(q)) / along;
      if (t > latest) {
        latest = t;
        side = k;
      }
    }
    return side;
  }

  std::span<const EdgePoint> edges_;
  const Board& board_;
  Eigen::Vector2d half_;
};

struct Candidate {
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();
  double cost = 0.0;
};

void Improve(const Fitter& fitter, int iterations, double reach, Candidate& candidate) {
  Eigen::Vector3d step;
  for (int i = 0; i < iterations; ++i) {
    fitter.Step(candidate.pose, reach, step);
    candidate.pose += step;
    if (step.norm() < 1e-7) break;
  }
  candidate.cost = fitter.Step(candidate.pose, kReach, step);
}

}  // namespace

std::optional<RectangleFit> FitRectangle(std::span<const EdgePoint> edges, const Board& board) {
  if (static_cast<int>(edges.size()) < kMinEdges) return std::nullopt;
  const Fitter fitter(edges, board);
  const double corner_up =
      std::numbers::pi / 2.0 - std::atan2(board.right_bottom_m, board.top_right_m);
  std::vector<Eigen::Vector3d> starts;
  for (int i = 0; i < kStarts; ++i) {
    const double share = (i + 0.5) / kStarts - 0.5;
    fitter.AddStarts(corner_up + share * std::numbers::pi / 2.0, starts);
  }
  std::vector<Candidate> candidates;
  for (const Eigen::Vector3d& start : starts) {
    candidates.push_back({start, 0.0});
    Improve(fitter, 0, kReach, candidates.back());
  }
  std::ranges::sort(candidates, {}, &Candidate::cost);
  candidates.resize(kStarts);
  for (Candidate& candidate : candidates) {
    Improve(fitter, kFirstIterations, kFirstReach, candidate);
  }
  std::ranges::sort(candidates, {}, &Candidate::cost);
  const Candidate* best = nullptr;
  for (Candidate& candidate : std::span(candidates).first(kFinalists)) {
    Improve(fitter, kIterations, kReach, candidate);
    const double off = std::abs(candidate.pose.z() - corner_up);
    if (off > std::numbers::pi / 4.0 + kAngleSlack_rad) continue;
    if (best == nullptr || candidate.cost < best->cost) best = &candidate;
  }
  if (best == nullptr) return std::nullopt;
  return fitter.Finish(best->pose);
}

}  // namespace sextant
