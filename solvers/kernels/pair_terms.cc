// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/pair_terms.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "solvers/kernels/pixel_pair_simd.h"

namespace sextant {
namespace {

// W with W^T W the inverse of the pair's covariance; the identity where it states none.
Eigen::Matrix3d Whitener(const Pair3d3d& pair) {
  if (pair.covariance_in_cam) {
    const Eigen::LLT<Eigen::Matrix3d> factor(*pair.covariance_in_cam);
    return factor.matrixL().solve(Eigen::Matrix3d::Identity().eval());
  }
  return Eigen::Matrix3d::Identity() / (pair.sigma_m > 0.0 ? pair.sigma_m : 1.0);
}

// Makes up to eight terms; returns whether all pairs state their noise.
template <class V>
SEXTANT_INLINE bool MakeBlockFor(std::span<const Pair2d3d> pairs, PixelBlock& block) {
  const EightPixelPairs<V> eight = GatherPixelPairs<V>(pairs);
  const MaskOf<V> known = eight.sigma > 0.0;
  StoreVec(eight.x, block.x);
  StoreVec(eight.y, block.y);
  StoreVec(eight.z, block.z);
  StoreVec(eight.u, block.u);
  StoreVec(eight.v, block.v);
  StoreVec(1.0 / Select(known, eight.sigma, All<V>(1.0)), block.inverse_sigma);
  for (std::size_t k = pairs.size(); k < kSimdWidth; ++k) block.inverse_sigma[k] = 0.0;
  return !AnyTrue(~known);
}
SEXTANT_SIMD_DISPATCH(bool, MakeBlock, (std::span<const Pair2d3d> pairs, PixelBlock& block),
                      (pairs, block))

}  // namespace

void PairTerms::Add(std::span<const Pair3d3d> pairs) {
  points.reserve(points.size() + pairs.size());
  for (const Pair3d3d& pair : pairs) {
    points.push_back({pair.point_in_cam, pair.point_in_lidar, Whitener(pair)});
    noise_known = noise_known && HasKnownNoise(pair);
  }
}

void PairTerms::Add(std::span<const Pair2d3d> pairs, const Camera& of_pairs) {
  camera = of_pairs;
  pixels.reserve(pixels.size() + pairs.size());
  // First fill the last block, then append block by block.
  for (; !pairs.empty() && pixels.size() % kSimdWidth != 0; pairs = pairs.subspan(1)) {
    const Pair2d3d& pair = pairs.front();
    const double sigma = pair.sigma_px > 0.0 ? pair.sigma_px : 1.0;
    pixels.push_back({pair.pixel, pair.point_in_lidar, 1.0 / sigma});
    noise_known = noise_known && HasKnownNoise(pair);
  }
  PixelBlock block;
  while (!pairs.empty()) {
    const std::size_t count = std::min(kSimdWidth, pairs.size());
    if (!MakeBlock(pairs.first(count), block)) noise_known = false;
    pixels.AppendBlock(block, count);
    pairs = pairs.subspan(count);
  }
}

void PairTerms::AssignSubset(const PairTerms& all, std::span<const int> indices) {
  points.clear();
  pixels.clear();
  camera = all.camera;
  noise_known = all.noise_known;
  all.pixels.empty() ? points.reserve(indices.size()) : pixels.reserve(indices.size());
  for (const int i : indices) {
    const auto index = static_cast<std::size_t>(i);
    if (all.pixels.empty()) {
      points.push_back(all.points[index]);
    } else {
      pixels.push_back(all.pixels[index]);
    }
  }
}

PairTerms MakeTerms(const CalibrationProblem& problem, PairKind kind) {
  PairTerms terms;
  if (kind == PairKind::k3d3d) {
    terms.Add(problem.pairs_3d3d);
  } else {
    terms.Add(problem.pairs_2d3d, *problem.camera);
  }
  return terms;
}

}  // namespace sextant
