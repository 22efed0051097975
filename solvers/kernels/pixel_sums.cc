// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/pixel_sums.h"

#include <cmath>
#include <limits>

#include "solvers/kernels/pixel_pair_simd.h"

namespace sextant {
namespace {

// Order of the sums: upper triangle of J^T J row by row, then J^T r, then r^T r.
constexpr int kSums = 28;
constexpr int kGradient = 21;
constexpr int kSquares = 27;

constexpr int AtTriangle(int row, int column) {
  return row * 6 - row * (row - 1) / 2 + column - row;
}

// Starting at index k: 8 - k ones, then zeros.
constexpr double kOnes[2 * kSimdWidth] = {1, 1, 1, 1, 1, 1, 1, 1};

template <class V>
struct EightTerms {
  V x, y, z, u, v, inverse_sigma;
};

template <class V>
SEXTANT_INLINE EightTerms<V> LoadTerms(const PixelBlock& block) {
  return {Load<V>(block.x), Load<V>(block.y), Load<V>(block.z),
          Load<V>(block.u), Load<V>(block.v), Load<V>(block.inverse_sigma)};
}

// Eight terms in the camera frame of the pose.
template <class V>
struct Seen {
  V arm[3];  // R p
  V depth;   // z of R p + t
  V inverse_depth;
  V x, y;  // (R p + t) / z
  V residual_u, residual_v;
  V focal_u, focal_v;  // Focal lengths over sigma.
};

template <class V>
SEXTANT_INLINE Seen<V> See(const EightTerms<V>& term, const PinholePose& pose) {
  const double* r = pose.r;
  Seen<V> seen;
  seen.arm[0] = r[0] * term.x + r[1] * term.y + r[2] * term.z;
  seen.arm[1] = r[3] * term.x + r[4] * term.y + r[5] * term.z;
  seen.arm[2] = r[6] * term.x + r[7] * term.y + r[8] * term.z;
  seen.depth = seen.arm[2] + pose.t[2];
  // Behind the camera any finite number will do.
  seen.inverse_depth = 1.0 / Select(seen.depth > 0.0, seen.depth, All<V>(1.0));
  seen.x = (seen.arm[0] + pose.t[0]) * seen.inverse_depth;
  seen.y = (seen.arm[1] + pose.t[1]) * seen.inverse_depth;
  seen.focal_u = term.inverse_sigma * pose.fx;
  seen.focal_v = term.inverse_sigma * pose.fy;
  seen.residual_u = term.inverse_sigma * (term.u - pose.cx) - seen.focal_u * seen.x;
  seen.residual_v = term.inverse_sigma * (term.v - pose.cy) - seen.focal_v * seen.y;
  return seen;
}

// The squared residuals; infinite behind the camera.
template <class V>
SEXTANT_INLINE V SquaresOf(const Seen<V>& seen) {
  const V squares = seen.residual_u * seen.residual_u + seen.residual_v * seen.residual_v;
  // The product overflows to infinity, but is zero where inverse_sigma is.
  constexpr double kHuge = std::numeric_limits<double>::max();
  return Select(seen.depth > 0.0, squares, seen.focal_u * kHuge * kHuge);
}

// A row of J has one zero: the u residual does not depend on y, nor v on x.
template <int kZero, class V>
SEXTANT_INLINE void AddRow(const V (&row)[5], const V& residual, V (&sums)[kSums]) {
  constexpr int kColumn[5] = {0, 1, 2, kZero == 4 ? 3 : 4, 5};
  for (int i = 0; i < 5; ++i) {
    for (int j = i; j < 5; ++j) sums[AtTriangle(kColumn[i], kColumn[j])] += row[i] * row[j];
    sums[kGradient + kColumn[i]] += row[i] * residual;
  }
}

// With g = d(x/z, y/z) / d(point), J is -(focal length) [arm x g, g].
template <class V>
SEXTANT_INLINE void AddDerivatives(const Seen<V>& seen, V (&sums)[kSums]) {
  const V slope_u = seen.focal_u * seen.inverse_depth;
  const V slope_v = seen.focal_v * seen.inverse_depth;
  const V lean_u = seen.x * slope_u;
  const V lean_v = seen.y * slope_v;
  const V row_u[5] = {lean_u * seen.arm[1], -(slope_u * seen.arm[2] + lean_u * seen.arm[0]),
                      slope_u * seen.arm[1], -slope_u, lean_u};
  const V row_v[5] = {slope_v * seen.arm[2] + lean_v * seen.arm[1], -(lean_v * seen.arm[0]),
                      -(slope_v * seen.arm[0]), -slope_v, lean_v};
  AddRow<4>(row_u, seen.residual_u, sums);
  AddRow<3>(row_v, seen.residual_v, sums);
}

template <class V>
SEXTANT_INLINE void Collect(const V (&vectors)[kSums], PixelSums& sums) {
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      sums.information(i, j) = sums.information(j, i) = HorizontalSum(vectors[AtTriangle(i, j)]);
    }
    sums.gradient(i) = HorizontalSum(vectors[kGradient + i]);
  }
  sums.squares = HorizontalSum(vectors[kSquares]);
}

template <class V>
SEXTANT_INLINE bool SumBlocksFor(std::span<const PixelBlock> blocks, const PinholePose& pose,
                                 PixelSums& sums) {
  V vectors[kSums] = {};
  MaskOf<V> behind{};
  for (const PixelBlock& block : blocks) {
    const Seen<V> seen = See(LoadTerms<V>(block), pose);
    behind |= ~(seen.depth > 0.0);
    AddDerivatives(seen, vectors);
    vectors[kSquares] += seen.residual_u * seen.residual_u + seen.residual_v * seen.residual_v;
  }
  if (AnyTrue(behind)) return false;
  Collect(vectors, sums);
  return true;
}
SEXTANT_SIMD_DISPATCH(bool, SumBlocks,
                      (std::span<const PixelBlock> blocks, const PinholePose& pose,
                       PixelSums& sums),
                      (blocks, pose, sums))

template <class V>
SEXTANT_INLINE int SumBlocksWithinFor(PixelTermsView terms, const PinholePose& pose,
                                      double max_squared, double cost_squared, PixelSums& sums) {
  V vectors[kSums] = {};
  V count{};
  for (const PixelBlock& block : terms.blocks()) {
    Seen<V> seen = See(LoadTerms<V>(block), pose);
    const V squares = SquaresOf(seen);
    const MaskOf<V> within = squares <= max_squared;
    vectors[kSquares] += Min(All<V>(cost_squared), squares);
    count += Keep(within, All<V>(1.0));
    seen.focal_u = Keep(within, seen.focal_u);
    seen.focal_v = Keep(within, seen.focal_v);
    seen.residual_u = Keep(within, seen.residual_u);
    seen.residual_v = Keep(within, seen.residual_v);
    AddDerivatives(seen, vectors);
  }
  Collect(vectors, sums);
  // The padding has zero residuals and was counted.
  const std::size_t beyond = kSimdWidth * terms.blocks().size() - terms.size();
  return static_cast<int>(HorizontalSum(count)) - static_cast<int>(beyond);
}
SEXTANT_SIMD_DISPATCH(int, SumBlocksWithin,
                      (PixelTermsView terms, const PinholePose& pose, double max_squared,
                       double cost_squared, PixelSums& sums),
                      (terms, pose, max_squared, cost_squared, sums))

template <class V>
SEXTANT_INLINE void SquareBlocksFor(std::span<const PixelBlock> blocks, const PinholePose& pose,
                                    double* squared) {
  for (const PixelBlock& block : blocks) {
    StoreVec(SquaresOf(See(LoadTerms<V>(block), pose)), squared);
    squared += kSimdWidth;
  }
}
SEXTANT_SIMD_DISPATCH(void, SquareBlocks,
                      (std::span<const PixelBlock> blocks, const PinholePose& pose,
                       double* squared),
                      (blocks, pose, squared))

template <class V>
SEXTANT_INLINE PixelErrors MeasurePairsFor(std::span<const Pair2d3d> pairs, const PinholePose& pose,
                                           std::span<double> distances_px) {
  V count{};
  V squares_px2{};
  V squares{};
  for (std::size_t at = 0; at < pairs.size(); at += kSimdWidth) {
    const std::size_t given = pairs.size() - at < kSimdWidth ? pairs.size() - at : kSimdWidth;
    const EightPixelPairs<V> eight = GatherPixelPairs<V>(pairs.subspan(at));
    const EightTerms<V> terms = {eight.x, eight.y, eight.z, eight.u, eight.v, All<V>(1.0)};
    const V squared = SquaresOf(See(terms, pose));
    const V sigma = Select(eight.sigma > 0.0, eight.sigma, All<V>(1.0));
    const V projects = Select(squared < std::numeric_limits<double>::infinity(),
                              Load<V>(kOnes + kSimdWidth - given), V{});
    const V counted = Select(projects > 0.0, squared, V{});
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

template <class V>
SEXTANT_INLINE double TruncatedCostFor(std::span<const PixelBlock> blocks, const PinholePose& pose,
                                       double max_squared, double give_up) {
  double cost = 0.0;
  for (const PixelBlock& block : blocks) {
    // A residual that is not a number counts as an outlier's.
    cost += HorizontalSum(Min(All<V>(max_squared), SquaresOf(See(LoadTerms<V>(block), pose))));
    if (!(cost < give_up)) break;
  }
  return cost;
}
SEXTANT_SIMD_DISPATCH(double, TruncatedCost,
                      (std::span<const PixelBlock> blocks, const PinholePose& pose,
                       double max_squared, double give_up),
                      (blocks, pose, max_squared, give_up))

template <class V>
SEXTANT_INLINE double ScreenedCostFor(std::span<const PixelBlock> blocks, const PinholePose& pose,
                                      double max_squared, double give_up,
                                      const PixelScreen& screen) {
  double cost = 0.0;
  double evidence = 0.0;
  for (const PixelBlock& block : blocks) {
    const V squares = SquaresOf(See(LoadTerms<V>(block), pose));
    const MaskOf<V> within = squares <= max_squared;
    cost += HorizontalSum(Min(All<V>(max_squared), squares));
    const double inliers = HorizontalSum(Keep(within, All<V>(1.0)));
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
  // A wrong pose has about one inlier in a hundred pairs; one good pose in a thousand may be lost.
  constexpr double kByChance = 0.01;
  constexpr double kMaxGoodLost = 1e-3;
  const double share = 0.5 * inlier_share;
  if (share <= 2.0 * kByChance) return;
  by_outlier = std::log((1.0 - kByChance) / (1.0 - share));
  by_inlier = std::log(kByChance / share);
  give_up = -std::log(kMaxGoodLost);
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
