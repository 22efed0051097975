// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/rivals.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "base/random.h"
#include "solvers/kernels/kabsch_fit.h"
#include "solvers/kernels/p3p.h"
#include "solvers/kernels/pair_terms.h"
#include "solvers/least_squares/refine_pose.h"

namespace sextant {
namespace {

constexpr int kMinSamples = 8;
constexpr int kMaxSamples = 64;
constexpr std::size_t kSampleSize = 3;
constexpr int kMaxRefits = 3;

using Sample = std::array<int, kSampleSize>;

std::vector<int> OthersOf(const std::vector<int>& chosen, std::size_t count) {
  std::vector<int> all(count);
  std::iota(all.begin(), all.end(), 0);
  std::vector<int> others;
  std::set_difference(all.begin(), all.end(), chosen.begin(), chosen.end(),
                      std::back_inserter(others));
  return others;
}

// Samples until one of the `wanted` among `count` pairs has been drawn with probability 0.999.
double SamplesFor(std::size_t count, std::size_t wanted) {
  double all = 1.0;
  for (std::size_t i = 0; i < kSampleSize; ++i) {
    all *= static_cast<double>(wanted - i) / static_cast<double>(count - i);
  }
  return all < 1.0 ? std::ceil(std::log(1e-3) / std::log1p(-all)) : 1.0;
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

/// Pairs of one kind as whitened terms.
class Pairs {
 public:
  Pairs(const CalibrationProblem& problem, PairKind kind, const Camera* camera) : kind_(kind) {
    terms_ = MakeTerms(problem, kind);
    if (camera != nullptr) terms_.camera = *camera;
  }

  double Squared(int index, const Rigid3d& pose) const {
    const auto i = static_cast<std::size_t>(index);
    if (kind_ == PairKind::k3d3d) {
      const PointTerm& term = terms_.points[i];
      return (term.whitener * (term.in_cam - pose * term.in_lidar)).squaredNorm();
    }
    const PixelTerm term = terms_.pixels[i];
    const auto projected = Project(terms_.camera, pose * term.in_lidar);
    if (!projected) return std::numeric_limits<double>::infinity();
    return (term.inverse_sigma * (term.pixel - *projected)).squaredNorm();
  }

  std::vector<int> Agreeing(const std::vector<int>& among, const Rigid3d& pose,
                            double max_squared) const {
    std::vector<int> agreeing;
    for (const int i : among) {
      if (Squared(i, pose) <= max_squared) agreeing.push_back(i);
    }
    return agreeing;
  }

  std::vector<Rigid3d> PosesOf(const Sample& sample) const {
    return kind_ == PairKind::k3d3d ? PosesOfPoints(sample) : PosesOfPixels(sample);
  }

  std::optional<Rigid3d> LeastSquares(const std::vector<int>& used, const Rigid3d& start) const {
    PairTerms terms;
    terms.AssignSubset(terms_, used);
    const RefinedPose refined = RefinePose(terms.View(), start, {.wants_information = false});
    if (refined.outcome == RefineOutcome::kNotProjected) return std::nullopt;
    return refined.cam_from_lidar;
  }

  // The probability that a random pair agrees with a pose: the ball or disc of the largest
  // residual over the box of the camera's points or pixels.
  double ChanceOfOne(double max_squared) const {
    const double radius = std::sqrt(max_squared);
    if (kind_ == PairKind::k3d3d) {
      Eigen::AlignedBox3d box;
      for (const PointTerm& term : terms_.points) box.extend(term.in_cam);
      const double r = radius / terms_.points.front().whitener(0, 0);
      const Eigen::Array3d sides = box.sizes().array() + 2.0 * r;
      return std::min(1.0, 4.0 / 3.0 * std::numbers::pi * r * r * r / sides.prod());
    }
    Eigen::AlignedBox2d box;
    for (const PixelTerm& term : terms_.pixels) box.extend(term.pixel);
    const double r = radius / terms_.pixels[0].inverse_sigma;
    const Eigen::Array2d sides = box.sizes().array() + 2.0 * r;
    return std::min(1.0, std::numbers::pi * r * r / sides.prod());
  }

 private:
  std::vector<Rigid3d> PosesOfPoints(const Sample& sample) const {
    std::array<Eigen::Vector3d, kSampleSize> in_cam;
    std::array<Eigen::Vector3d, kSampleSize> in_lidar;
    for (std::size_t i = 0; i < kSampleSize; ++i) {
      in_cam[i] = terms_.points[static_cast<std::size_t>(sample[i])].in_cam;
      in_lidar[i] = terms_.points[static_cast<std::size_t>(sample[i])].in_lidar;
    }
    const KabschOutcome fit = FitPoints(in_cam, in_lidar, {});
    if (!fit) return {};
    return {fit->b_from_a};
  }

  std::vector<Rigid3d> PosesOfPixels(const Sample& sample) const {
    std::array<Eigen::Vector3d, kSampleSize> rays;
    std::array<Eigen::Vector3d, kSampleSize> points;
    for (std::size_t i = 0; i < kSampleSize; ++i) {
      const PixelTerm term = terms_.pixels[static_cast<std::size_t>(sample[i])];
      const std::optional<Eigen::Vector3d> ray = Unproject(terms_.camera, term.pixel);
      if (!ray) return {};
      rays[i] = *ray;
      points[i] = term.in_lidar;
    }
    std::array<Rigid3d, kMaxP3pPoses> poses;
    const int count = SolveP3p(rays, points, poses);
    return {poses.begin(), poses.begin() + count};
  }

  PairKind kind_;
  PairTerms terms_;
};

/// The pose of samples of `among` that the most of these agree on, after least squares on them.
struct Consensus {
  Rigid3d pose;
  std::vector<int> agreeing;
};

Consensus SearchAmong(const std::vector<int>& among, const Pairs& pairs, double max_squared,
                      int samples) {
  // Poses of three pairs carry their noise, so that the others are further off than in the end.
  constexpr double kWidening = 4.0;
  Random random(1);
  Consensus best;
  Sample sample{};
  for (int i = 0; i < samples; ++i) {
    random.Sample(static_cast<int>(among.size()), sample);
    for (int& index : sample) index = among[static_cast<std::size_t>(index)];
    for (const Rigid3d& pose : pairs.PosesOf(sample)) {
      std::vector<int> agreeing = pairs.Agreeing(among, pose, kWidening * max_squared);
      if (agreeing.size() > best.agreeing.size()) best = {pose, std::move(agreeing)};
    }
  }
  for (int refit = 0; refit < kMaxRefits && best.agreeing.size() > kSampleSize; ++refit) {
    const std::optional<Rigid3d> pose = pairs.LeastSquares(best.agreeing, best.pose);
    if (!pose) break;
    best = {*pose, pairs.Agreeing(among, *pose, max_squared)};
  }
  return best;
}

}  // namespace

std::vector<Rigid3d> FindRivals(const CalibrationProblem& problem, const SolverSpec& spec,
                                const Estimate& answer) {
  const DataNeeds& needs = spec.needs;
  const bool one_kind = (needs.pairs_3d3d > 0) != (needs.pairs_2d3d > 0);
  if (!one_kind || needs.board_views > 0 || !FindsWholePose(spec)) return {};
  const PairKind kind = needs.pairs_3d3d > 0 ? PairKind::k3d3d : PairKind::k2d3d;
  const std::size_t count =
      kind == PairKind::k3d3d ? problem.pairs_3d3d.size() : problem.pairs_2d3d.size();
  const std::size_t used = answer.inliers.size();
  const auto wanted = std::max<std::size_t>(
      kSampleSize + 1,
      static_cast<std::size_t>(std::ceil(kRivalShare * static_cast<double>(used))));
  if (used == 0 || count < used + wanted) return {};
  const double samples = SamplesFor(count - used, wanted);
  if (samples > kMaxSamples) return {};

  const Pairs pairs(problem, kind, answer.camera ? &answer.camera->camera : nullptr);
  double largest = 0.0;
  for (const int i : answer.inliers) {
    largest = std::max(largest, pairs.Squared(i, answer.cam_from_lidar));
  }
  // Twice the largest residual. Where all pairs are exact, rounding still is not.
  constexpr double kRounding = 1e-12;
  const double max_squared = 4.0 * largest + kRounding;
  const Consensus rival = SearchAmong(OthersOf(answer.inliers, count), pairs, max_squared,
                                      std::max(kMinSamples, static_cast<int>(samples)));
  constexpr double kMaxChance = 0.01;
  if (rival.agreeing.size() < wanted ||
      ChanceOf(kind, rival.agreeing.size(), count - used, pairs.ChanceOfOne(max_squared)) >
          kMaxChance ||
      2 * pairs.Agreeing(answer.inliers, rival.pose, max_squared).size() > used) {
    return {};
  }
  return {rival.pose};
}

}  // namespace sextant
