// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/pixel_sums.h"

#include <cmath>
#include <limits>

#include "solvers/kernels/pixel_pair_simd.h"

namespace sextant {
namespace {

// Upper triangle of J^T J row by row, then J^T r, then r^T r.
constexpr int kSums = 28;
constexpr int kGradient = 21;
constexpr int kSquares = 27;

constexpr int AtTriangle(int row, int column) {
  return row * 6 - row * (row - 1) / 2 + column - row;
}

// From the k-th on, 8 - k ones, then zeros.
constexpr double kOnes[2 * kSimdWidth] = {1, 1, 1, 1, 1, 1, 1, 1};

template <class L>
struct EightTerms {
  L x, y, z, u, v, inverse_sigma;
};

template <class L>
SEXTANT_INLINE EightTerms<L> LoadTerms(const PixelBlock& block) {
  return {Load<L>(block.x), Load<L>(block.y), Load<L>(block.z),
          Load<L>(block.u), Load<L>(block.v), Load<L>(block.inverse_sigma)};
}

// Eight terms seen from the pose.
template <class L>
struct Seen {
  L arm[3];  // R p
  L depth;   // z of R p + t
  L inverse_depth;
  L x, y;  // (R p + t) / z
  L residual_u, residual_v;
  L focal_u, focal_v;  // Focal lengths over sigma.
};

template <class L>
SEXTANT_INLINE Seen<L> See(const EightTerms<L>& term, const PinholePose& pose) {
  const double* r = pose.r;
  Seen<L> seen;
  seen.arm[0] = r[0] * term.x + r[1] * term.y + r[2] * term.z;
  seen.arm[1] = r[3] * term.x + r[4] * term.y + r[5] * term.z;
  seen.arm[2] = r[6] * term.x + r[7] * term.y + r[8] * term.z;
  seen.depth = seen.arm[2] + pose.t[2];
  // Behind the camera any number will do.
  seen.inverse_depth = 1.0 / Select(seen.depth > 0.0, seen.depth, All<L>(1.0));
  seen.x = (seen.arm[0] + pose.t[0]) * seen.inverse_depth;
  seen.y = (seen.arm[1] + pose.t[1]) * seen.inverse_depth;
  seen.focal_u = term.inverse_sigma * pose.fx;
  seen.focal_v = term.inverse_sigma * pose.fy;
  seen.residual_u = term.inverse_sigma * (term.u - pose.cx) - seen.focal_u * seen.x;
  seen.residual_v = term.inverse_sigma * (term.v - pose.cy) - seen.focal_v * seen.y;
  return seen;
}

// The squared residuals; infinite behind the camera.
template <class L>
SEXTANT_INLINE L SquaresOf(const Seen<L>& seen) {
  const L squares = seen.residual_u * seen.residual_u + seen.residual_v * seen.residual_v;
  // Infinite, but zero where inverse_sigma is.
  constexpr double kHuge = std::numeric_limits<double>::max();
  return Select(seen.depth > 0.0, squares, seen.focal_u * kHuge * kHuge);
}

// A row of J has one zero: the u residual does not depend on y, nor v on x.
template <int kZero, class L>
SEXTANT_INLINE void AddRow(const L (&row)[5], const L& residual, L (&sums)[kSums]) {
  constexpr int kColumn[5] = {0, 1, 2, kZero == 4 ? 3 : 4, 5};
  for (int i = 0; i < 5; ++i) {
    for (int j = i; j < 5; ++j) sums[AtTriangle(kColumn[i], kColumn[j])] += row[i] * row[j];
    sums[kGradient + kColumn[i]] += row[i] * residual;
  }
}

// With g = d(x/z, y/z) / d(point), J is -(focal length) [arm x g, g].
template <class L>
SEXTANT_INLINE void AddDerivatives(const Seen<L>& seen, L (&sums)[kSums]) {
  const L slope_u = seen.focal_u * seen.inverse_depth;
  const L slope_v = seen.focal_v * seen.inverse_depth;
  const L lean_u = seen.x * slope_u;
  const L lean_v = seen.y * slope_v;
  const L row_u[5] = {lean_u * seen.arm[1], -(slope_u * seen.arm[2] + lean_u * seen.arm[0]),
                      slope_u * seen.arm[1], -slope_u, lean_u};
  const L row_v[5] = {slope_v * seen.arm[2] + lean_v * seen.arm[1], -(lean_v * seen.arm[0]),
                      -(slope_v * seen.arm[0]), -slope_v, lean_v};
  AddRow<4>(row_u, seen.residual_u, sums);
  AddRow<3>(row_v, seen.residual_v, sums);
}

template <class L>
SEXTANT_INLINE void Collect(const L (&lanes)[kSums], PixelSums& sums) {
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      sums.information(i, j) = sums.information(j, i) = HorizontalSum(lanes[AtTriangle(i, j)]);
    }
    sums.gradient(i) = HorizontalSum(lanes[kGradient + i]);
  }
  sums.squares = HorizontalSum(lanes[kSquares]);
}

template <class L>
SEXTANT_INLINE bool SumBlocksFor(std::span<const PixelBlock> blocks, const PinholePose& pose,
                                 PixelSums& sums) {
  L lanes[kSums] = {};
  MaskOf<L> behind{};
  for (const PixelBlock& block : blocks) {
    const Seen<L> seen = See(LoadTerms<L>(block), pose);
    behind |= ~(seen.depth > 0.0);
    AddDerivatives(seen, lanes);
    lanes[kSquares] += seen.residual_u * seen.residual_u + seen.residual_v * seen.residual_v;
  }
  if (AnyTrue(behind)) return false;
  Collect(lanes, sums);
  return true;
}
SEXTANT_SIMD_DISPATCH(bool, SumBlocks,
                      (std::span<const PixelBlock> blocks, const PinholePose& pose,
                       PixelSums& sums),
                      (blocks, pose, sums))

template <class L>
SEXTANT_INLINE int SumBlocksWithinFor(PixelTermsView terms, const PinholePose& pose,
                                      double max_squared, double cost_squared, PixelSums& sums) {
  L lanes[kSums] = {};
  L count{};
  for (const PixelBlock& block : terms.blocks()) {
    Seen<L> seen = See(LoadTerms<L>(block), pose);
    const L squares = SquaresOf(seen);
    const MaskOf<L> within = squares <= max_squared;
    lanes[kSquares] += Min(All<L>(cost_squared), squares);
    count += Keep(within, All<L>(1.0));
    seen.focal_u = Keep(within, seen.focal_u);
    seen.focal_v = Keep(within, seen.focal_v);
    seen.residual_u = Keep(within, seen.residual_u);
    seen.residual_v = Keep(within, seen.residual_v);
    AddDerivatives(seen, lanes);
  }
  Collect(lanes, sums);
  // Places beyond the last term have no residual.
  const std::size_t beyond = kSimdWidth * terms.blocks().size() - terms.size();
  return static_cast<int>(HorizontalSum(count)) - static_cast<int>(beyond);
}
SEXTANT_SIMD_DISPATCH(int, SumBlocksWithin,
                      (PixelTermsView terms, const PinholePose& pose, double max_squared,
                       double cost_squared, PixelSums& sums),
                      (terms, pose, max_squared, cost_squared, sums))

template <class L>
SEXTANT_INLINE void SquareBlocksFor(std::span<const PixelBlock> blocks, const PinholePose& pose,
                                    double* squared) {
  for (const PixelBlock& block : blocks) {
    StoreVec(SquaresOf(See(LoadTerms<L>(block), pose)), squared);
    squared += kSimdWidth;
  }
}
SEXTANT_SIMD_DISPATCH(void, SquareBlocks,
                      (std::span<const PixelBlock> blocks, const PinholePose& pose,
                       double* squared),
                      (blocks, pose, squared))

template <class L>
SEXTANT_INLINE PixelErrors MeasurePairsFor(std::span<const Pair2d3d> pairs, const PinholePose& pose,
                                           std::span<double> distances_px) {
  L count{};
  L squares_px2{};
  L squares{};
  for (std::size_t at = 0; at < pairs.size(); at += kSimdWidth) {
    const std::size_t given = pairs.size() - at < kSimdWidth ? pairs.size() - at : kSimdWidth;
    const EightPixelPairs<L> eight = GatherPixelPairs<L>(pairs.subspan(at));
    const EightTerms<L> terms = {eight.x, eight.y, eight.z, eight.u, eight.v, All<L>(1.0)};
    const L squared = SquaresOf(See(terms, pose));
    const L sigma = Select(eight.sigma > 0.0, eight.sigma, All<L>(1.0));
    const L projects = Select(squared < std::numeric_limits<double>::infinity(),
                              Load<L>(kOnes + kSimdWidth - given), L{});
    const L counted = Select(projects > 0.0, squared, L{});
    count += projects;
    squares_px2 += counted;
    squares += counted * (1.0 / (sigma * sigma));
    double distances[kSimdWidth];
    StoreVec(Sqrt(squared), distances);
    std::memcpy(&distances_px[at], distances, given * sizeof(double));
  }
  return {static_cast<int>(HorizontalSum(count)), HorizontalSum(squares_px2),
          HorizontalSum(squares)};
}
SEXTANT_SIMD_DISPATCH(PixelErrors, MeasurePairs,
                      (std::span<const Pair2d3d> pairs, const PinholePose& pose,
                       std::span<double> distances_px),
                      (pairs, pose, distances_px))

template <class L>
SEXTANT_INLINE double TruncatedCostFor(std::span<const PixelBlock> blocks, const PinholePose& pose,
                                       double max_squared, double give_up) {
  double cost = 0.0;
  for (const PixelBlock& block : blocks) {
    // A residual that is not a number counts as an outlier's.
    cost += HorizontalSum(Min(All<L>(max_squared), SquaresOf(See(LoadTerms<L>(block), pose))));
    if (!(cost < give_up)) break;
  }
  return cost;
}
SEXTANT_SIMD_DISPATCH(double, TruncatedCost,
                      (std::span<const PixelBlock> blocks, const PinholePose& pose,
                       double max_squared, double give_up),
                      (blocks, pose, max_squared, give_up))

template <class L>
SEXTANT_INLINE double ScreenedCostFor(std::span<const PixelBlock> blocks, const PinholePose& pose,
                                      double max_squared, double give_up,
                                      const PixelScreen& screen) {
  double cost = 0.0;
  double evidence = 0.0;
  for (const PixelBlock& block : blocks) {
    const L squares = SquaresOf(See(LoadTerms<L>(block), pose));
    const MaskOf<L> within = squares <= max_squared;
    cost += HorizontalSum(Min(All<L>(max_squared), squares));
    const double inliers = HorizontalSum(Keep(within, All<L>(1.0)));
    evidence += inliers * screen.by_inlier + (8.0 - inliers) * screen.by_outlier;
    if (!(cost < give_up)) break;
    if (evidence > screen.give_up) return std::numeric_limits<double>::infinity();
  }
  return cost;
}
SEXTANT_SIMD_DISPATCH(double, ScreenedCost,
                      (std::span<const PixelBlock> blocks, const PinholePose& pose,
                       double max_squared, double give_up, const PixelScreen& screen),
                      (blocks, pose, max_squared, give_up, screen))

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

bool SumPixels(std::span<const PixelBlock> blocks, const PinholePose& pose, PixelSums& sums) {
  return SumBlocks(blocks, pose, sums);
}

int SumPixelsWithin(PixelTermsView terms, const PinholePose& pose, double max_squared,
                    double cost_squared, PixelSums& sums) {
  return SumBlocksWithin(terms, pose, max_squared, cost_squared, sums);
}

void SquarePixels(std::span<const PixelBlock> blocks, const PinholePose& pose, double* squared) {
  SquareBlocks(blocks, pose, squared);
}

PixelErrors MeasurePixels(std::span<const Pair2d3d> pairs, const PinholePose& pose,
                          std::span<double> distances_px) {
  return MeasurePairs(pairs, pose, distances_px);
}

double TruncatedPixelCost(std::span<const PixelBlock> blocks, const PinholePose& pose,
                          double max_squared, double give_up) {
  return TruncatedCost(blocks, pose, max_squared, give_up);
}

double ScreenedPixelCost(std::span<const PixelBlock> blocks, const PinholePose& pose,
                         double max_squared, double give_up, const PixelScreen& screen) {
  return ScreenedCost(blocks, pose, max_squared, give_up, screen);
}

}  // namespace sextant
