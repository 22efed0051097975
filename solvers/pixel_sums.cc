// SPDX-License-Identifier: Apache-2.0
#include "solvers/pixel_sums.h"

#include <cmath>
#include <limits>

namespace sextant {
namespace {

// Upper triangle of J^T J row by row, then J^T r, then r^T r.
constexpr int kSums = 28;
constexpr int kGradient = 21;
constexpr int kSquares = 27;

constexpr int AtTriangle(int row, int column) {
  return row * 6 - row * (row - 1) / 2 + column - row;
}

// Eight terms seen from the pose.
struct Seen {
  Lanes arm[3];  // R p
  Lanes depth;   // z of R p + t
  Lanes inverse_depth;
  Lanes x, y;  // (R p + t) / z
  Lanes residual_u, residual_v;
  Lanes focal_u, focal_v;  // Focal lengths over sigma.
};

SEXTANT_INLINE Seen See(const PixelBlock& block, const PinholePose& pose) {
  const Lanes px = LoadLanes(block.x);
  const Lanes py = LoadLanes(block.y);
  const Lanes pz = LoadLanes(block.z);
  const double* r = pose.r;
  Seen seen;
  seen.arm[0] = r[0] * px + r[1] * py + r[2] * pz;
  seen.arm[1] = r[3] * px + r[4] * py + r[5] * pz;
  seen.arm[2] = r[6] * px + r[7] * py + r[8] * pz;
  seen.depth = seen.arm[2] + pose.t[2];
  // Behind the camera any number will do.
  seen.inverse_depth = 1.0 / (seen.depth > 0.0 ? seen.depth : AllLanes(1.0));
  seen.x = (seen.arm[0] + pose.t[0]) * seen.inverse_depth;
  seen.y = (seen.arm[1] + pose.t[1]) * seen.inverse_depth;
  const Lanes inverse_sigma = LoadLanes(block.inverse_sigma);
  seen.focal_u = inverse_sigma * pose.fx;
  seen.focal_v = inverse_sigma * pose.fy;
  seen.residual_u = inverse_sigma * (LoadLanes(block.u) - pose.cx) - seen.focal_u * seen.x;
  seen.residual_v = inverse_sigma * (LoadLanes(block.v) - pose.cy) - seen.focal_v * seen.y;
  return seen;
}

// Zero where the mask does not hold, whatever is there.
SEXTANT_INLINE Lanes Keep(const LaneMask& mask, const Lanes& lanes) {
  return reinterpret_cast<Lanes>(mask & reinterpret_cast<LaneMask>(lanes));
}

// The squared residuals; infinite behind the camera.
SEXTANT_INLINE Lanes SquaresOf(const Seen& seen) {
  const Lanes squares = seen.residual_u * seen.residual_u + seen.residual_v * seen.residual_v;
  // Infinite, but zero where inverse_sigma is.
  constexpr double kHuge = std::numeric_limits<double>::max();
  return seen.depth > 0.0 ? squares : seen.focal_u * kHuge * kHuge;
}

// A row of J has one zero: the u residual does not depend on y, nor v on x.
template <int kZero>
SEXTANT_INLINE void AddRow(const Lanes (&row)[5], const Lanes& residual, Lanes (&sums)[kSums]) {
  constexpr int kColumn[5] = {0, 1, 2, kZero == 4 ? 3 : 4, 5};
  for (int i = 0; i < 5; ++i) {
    for (int j = i; j < 5; ++j) sums[AtTriangle(kColumn[i], kColumn[j])] += row[i] * row[j];
    sums[kGradient + kColumn[i]] += row[i] * residual;
  }
}

// With g = d(x/z, y/z) / d(point), J is -(focal length) [arm x g, g].
SEXTANT_INLINE void AddDerivatives(const Seen& seen, Lanes (&sums)[kSums]) {
  const Lanes slope_u = seen.focal_u * seen.inverse_depth;
  const Lanes slope_v = seen.focal_v * seen.inverse_depth;
  const Lanes lean_u = seen.x * slope_u;
  const Lanes lean_v = seen.y * slope_v;
  const Lanes row_u[5] = {lean_u * seen.arm[1], -(slope_u * seen.arm[2] + lean_u * seen.arm[0]),
                          slope_u * seen.arm[1], -slope_u, lean_u};
  const Lanes row_v[5] = {slope_v * seen.arm[2] + lean_v * seen.arm[1], -(lean_v * seen.arm[0]),
                          -(slope_v * seen.arm[0]), -slope_v, lean_v};
  AddRow<4>(row_u, seen.residual_u, sums);
  AddRow<3>(row_v, seen.residual_v, sums);
}

SEXTANT_INLINE void Collect(const Lanes (&lanes)[kSums], PixelSums& sums) {
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      sums.information(i, j) = sums.information(j, i) = SumLanes(lanes[AtTriangle(i, j)]);
    }
    sums.gradient(i) = SumLanes(lanes[kGradient + i]);
  }
  sums.squares = SumLanes(lanes[kSquares]);
}

}  // namespace

PinholePose::PinholePose(const Camera& camera, const Rigid3d& cam_from_lidar)
    : fx(camera.fx_px), fy(camera.fy_px), cx(camera.cx_px), cy(camera.cy_px) {
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(r);
  rotation = cam_from_lidar.rotation.toRotationMatrix();
  for (int k = 0; k < 3; ++k) t[k] = cam_from_lidar.translation[k];
}

PinholePose::PinholePose(const Camera& camera, const P3pPoses& poses, std::size_t candidate,
                         std::size_t triple)
    : fx(camera.fx_px), fy(camera.fy_px), cx(camera.cx_px), cy(camera.cy_px) {
  for (int k = 0; k < 9; ++k) r[k] = poses.rotation[candidate][k][triple];
  for (int k = 0; k < 3; ++k) t[k] = poses.translation[candidate][k][triple];
}

PixelScreen::PixelScreen(double inlier_share) {
  // Of wrong poses about one pair in a hundred is an inlier; one good pose in a thousand may go.
  constexpr double kByChance = 0.01;
  constexpr double kGoodGivenUp = 1e-3;
  const double share = 0.5 * inlier_share;
  if (share <= 2.0 * kByChance) return;
  by_outlier = std::log((1.0 - kByChance) / (1.0 - share));
  by_inlier = std::log(kByChance / share);
  give_up = -std::log(kGoodGivenUp);
}

SEXTANT_MULTIVERSION
bool SumPixels(std::span<const PixelBlock> blocks, const PinholePose& pose, PixelSums& sums) {
  Lanes lanes[kSums] = {};
  LaneMask behind = {};
  for (const PixelBlock& block : blocks) {
    const Seen seen = See(block, pose);
    behind |= ~(seen.depth > 0.0);
    AddDerivatives(seen, lanes);
    lanes[kSquares] += seen.residual_u * seen.residual_u + seen.residual_v * seen.residual_v;
  }
  if (AnyLane(behind)) return false;
  Collect(lanes, sums);
  return true;
}

SEXTANT_MULTIVERSION
int SumPixelsWithin(PixelTermsView terms, const PinholePose& pose, double max_squared,
                    double cost_squared, PixelSums& sums) {
  Lanes lanes[kSums] = {};
  Lanes count = {};
  for (const PixelBlock& block : terms.blocks()) {
    Seen seen = See(block, pose);
    const Lanes squares = SquaresOf(seen);
    const LaneMask within = squares <= max_squared;
    lanes[kSquares] += Min(AllLanes(cost_squared), squares);
    count += Keep(within, AllLanes(1.0));
    seen.focal_u = Keep(within, seen.focal_u);
    seen.focal_v = Keep(within, seen.focal_v);
    seen.residual_u = Keep(within, seen.residual_u);
    seen.residual_v = Keep(within, seen.residual_v);
    AddDerivatives(seen, lanes);
  }
  Collect(lanes, sums);
  // Places beyond the last term have no residual.
  const std::size_t beyond = kLanes * terms.blocks().size() - terms.size();
  return static_cast<int>(SumLanes(count)) - static_cast<int>(beyond);
}

SEXTANT_MULTIVERSION
void SquarePixels(std::span<const PixelBlock> blocks, const PinholePose& pose, double* squared) {
  for (const PixelBlock& block : blocks) {
    StoreLanes(SquaresOf(See(block, pose)), squared);
    squared += kLanes;
  }
}

SEXTANT_MULTIVERSION
PixelErrors MeasurePixels(std::span<const Pair2d3d> pairs, const PinholePose& pose,
                          std::span<double> distances_px) {
  Lanes count = {};
  Lanes squares_px2 = {};
  Lanes squares = {};
  for (std::size_t at = 0; at < pairs.size(); at += kLanes) {
    const std::size_t left = pairs.size() - at;
    PixelBlock block;
    Lanes inverse_variance;
    Lanes given;
    for (std::size_t k = 0; k < kLanes; ++k) {
      const Pair2d3d& pair = pairs[at + (k < left ? k : 0)];
      block.x[k] = pair.point_in_lidar.data()[0];
      block.y[k] = pair.point_in_lidar.data()[1];
      block.z[k] = pair.point_in_lidar.data()[2];
      block.u[k] = pair.pixel.data()[0];
      block.v[k] = pair.pixel.data()[1];
      block.inverse_sigma[k] = 1.0;
      const double sigma = pair.sigma_px > 0.0 ? pair.sigma_px : 1.0;
      inverse_variance[k] = sigma * sigma;
      given[k] = k < left ? 1.0 : 0.0;
    }
    inverse_variance = 1.0 / inverse_variance;
    const Lanes squared = SquaresOf(See(block, pose));
    const Lanes projects = squared < std::numeric_limits<double>::infinity() ? given : Lanes{};
    const Lanes counted = projects > 0.0 ? squared : Lanes{};
    count += projects;
    squares_px2 += counted;
    squares += counted * inverse_variance;
    double distances[kLanes];
    StoreLanes(Sqrt(squared), distances);
    for (std::size_t k = 0; k < (left < kLanes ? left : kLanes); ++k) {
      distances_px[at + k] = distances[k];
    }
  }
  return {static_cast<int>(SumLanes(count)), SumLanes(squares_px2), SumLanes(squares)};
}

SEXTANT_MULTIVERSION
double TruncatedPixelCost(std::span<const PixelBlock> blocks, const PinholePose& pose,
                          double max_squared, double give_up) {
  double cost = 0.0;
  for (const PixelBlock& block : blocks) {
    // A residual that is not a number counts as an outlier's.
    cost += SumLanes(Min(AllLanes(max_squared), SquaresOf(See(block, pose))));
    if (!(cost < give_up)) break;
  }
  return cost;
}

SEXTANT_MULTIVERSION
double ScreenedPixelCost(std::span<const PixelBlock> blocks, const PinholePose& pose,
                         double max_squared, double give_up, const PixelScreen& screen) {
  double cost = 0.0;
  double evidence = 0.0;
  for (const PixelBlock& block : blocks) {
    const Lanes squares = SquaresOf(See(block, pose));
    const LaneMask within = squares <= max_squared;
    cost += SumLanes(Min(AllLanes(max_squared), squares));
    const double inliers = SumLanes(Keep(within, AllLanes(1.0)));
    evidence += inliers * screen.by_inlier + (8.0 - inliers) * screen.by_outlier;
    if (!(cost < give_up)) break;
    if (evidence > screen.give_up) return std::numeric_limits<double>::infinity();
  }
  return cost;
}

}  // namespace sextant
