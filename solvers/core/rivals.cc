// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/rivals.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/random.h"
#include "solvers/core/sampled_pairs.h"
#include "solvers/kernels/p3p.h"

namespace sextant {
namespace {

constexpr int kMaxSamples = 64;
constexpr int kMaxRefits = 3;

std::vector<int> OthersOf(const std::vector<int>& chosen, std::size_t count) {
  std::vector<int> others;
  others.reserve(count - chosen.size());
  auto next = chosen.begin();
  for (int i = 0; i < static_cast<int>(count); ++i) {
    if (next != chosen.end() && *next == i) {
      ++next;
    } else {
      others.push_back(i);
    }
  }
  return others;
}

// Samples until one of the `wanted` among `count` pairs has been drawn with probability 0.9; of
// more than these it is nearer to 1.
double SamplesFor(std::size_t count, std::size_t wanted) {
  double all = 1.0;
  for (std::size_t i = 0; i < kPairTriple; ++i) {
    all *= static_cast<double>(wanted - i) / static_cast<double>(count - i);
  }
  return all < 1.0 ? std::ceil(std::log(0.1) / std::log1p(-all)) : 1.0;
}

/// The expected number of poses that `agreeing` of `count` pairs agree on by chance, each with
/// probability p, where three pairs fix a pose: at most C(count, 3) C(count - 3, k) p^k with
/// k = agreeing - 3. Two points of a 3D-3D triple fix nearly all of a pose: there the third counts.
double ChanceOf(PairKind kind, std::size_t agreeing, std::size_t count, double p) {
  const double absorbed = kind == PairKind::k3d3d ? 2.0 : 3.0;
  const double n = static_cast<double>(count);
  const double k = static_cast<double>(agreeing) - absorbed;
  double log_chance = k * std::log(p);
  for (double i = 0.0; i < absorbed; ++i) log_chance += std::log((n - i) / (i + 1.0));
  for (double i = 0.0; i < k; ++i) log_chance += std::log((n - absorbed - i) / (i + 1.0));
  return std::exp(log_chance);
}

// Where all pairs are exact, rounding still is not.
constexpr double kRounding = 1e-12;

PairTriple DrawFrom(const std::vector<int>& among, Random& random) {
  const auto draw = [&] { return among[random.Below(among.size())]; };
  PairTriple sample{};
  auto& [a, b, c] = sample;
  a = draw();
  do b = draw();
  while (b == a);
  do c = draw();
  while (c == a || c == b);
  return sample;
}

/// The pose of samples of `among` that the most of these agree on, after least squares on them.
struct Consensus {
  Rigid3d pose;
  std::vector<int> agreeing;
};

Consensus SearchAmong(const std::vector<int>& among, const SampledPairs& pairs, double max_squared,
                      int samples) {
  // Poses of three pairs carry their noise, so that the others are further off than in the end.
  constexpr double kWidening = 4.0;
  Random random(1);
  Consensus best;
  std::vector<MatrixPose> poses;
  poses.reserve(kMaxP3pPoses);
  for (int drawn = 0; drawn < samples; ++drawn) {
    poses.clear();
    pairs.AddPosesOf(DrawFrom(among, random), poses);
    for (const MatrixPose& pose : poses) {
      if (!pairs.MostMayAgree(among, pose, kWidening * max_squared)) continue;
      std::vector<int> agreeing = pairs.Agreeing(among, pose, kWidening * max_squared);
      if (agreeing.size() > best.agreeing.size()) best = {pose.Rigid(), std::move(agreeing)};
    }
  }
  for (int refit = 0; refit < kMaxRefits && best.agreeing.size() > kPairTriple; ++refit) {
    const std::optional<Rigid3d> pose = pairs.LeastSquares(best.agreeing, best.pose);
    if (!pose) break;
    best = {*pose, pairs.Agreeing(among, MatrixOf(*pose), max_squared)};
  }
  return best;
}

}  // namespace

std::vector<Rigid3d> FindRivals(const CalibrationProblem& problem, const SolverSpec& spec,
                                const SolveReport& answer) {
  const DataNeeds& needs = spec.needs;
  const bool one_kind = (needs.pairs_3d3d > 0) != (needs.pairs_2d3d > 0);
  if (!one_kind || needs.board_views > 0 || !FindsWholePose(spec)) return {};
  const PairKind kind = needs.pairs_3d3d > 0 ? PairKind::k3d3d : PairKind::k2d3d;
  const std::size_t count =
      kind == PairKind::k3d3d ? problem.pairs_3d3d.size() : problem.pairs_2d3d.size();
  const std::size_t used = answer.inliers.size();
  const auto wanted = std::max<std::size_t>(
      kPairTriple + 1,
      static_cast<std::size_t>(std::ceil(kRivalShare * static_cast<double>(used))));
  if (used == 0 || count < used + wanted) return {};
  const double samples = SamplesFor(count - used, wanted);
  if (samples > kMaxSamples) return {};

  const Camera* camera = answer.camera    ? &answer.camera->camera
                         : problem.camera ? &*problem.camera
                                          : nullptr;
  const SampledPairs pairs(problem, kind, camera);
  // Twice the largest residual.
  const double max_squared = 4.0 * pairs.LargestSquared(answer) + kRounding;
  const Consensus rival =
      SearchAmong(OthersOf(answer.inliers, count), pairs, max_squared, static_cast<int>(samples));
  constexpr double kMaxChance = 0.01;
  if (rival.agreeing.size() < wanted ||
      ChanceOf(kind, rival.agreeing.size(), count - used, pairs.ChanceOfOne(max_squared)) >
          kMaxChance ||
      2 * pairs.Agreeing(answer.inliers, MatrixOf(rival.pose), max_squared).size() > used) {
    return {};
  }
  return {rival.pose};
}

}  // namespace sextant
