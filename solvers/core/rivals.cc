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
#include "geometry/residuals.h"
#include "solvers/core/subset.h"
#include "solvers/kernels/kabsch_fit.h"
#include "solvers/kernels/p3p.h"
#include "solvers/kernels/pair_terms.h"
#include "solvers/least_squares/refine_pose.h"

namespace sextant {
namespace {

constexpr int kMaxSamples = 64;
constexpr std::size_t kSampleSize = 3;
constexpr int kMaxRefits = 3;

using Sample = std::array<int, kSampleSize>;

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
  for (std::size_t i = 0; i < kSampleSize; ++i) {
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

double Variance(const Pair3d3d& pair) {
  return HasKnownNoise(pair) ? pair.sigma_m * pair.sigma_m : 1.0;
}
double Variance(const Pair2d3d& pair) {
  return HasKnownNoise(pair) ? pair.sigma_px * pair.sigma_px : 1.0;
}

/// A pose in the form that a few residuals need.
struct MatrixPose {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;

  Eigen::Vector3d At(const Eigen::Vector3d& p) const {
    return rotation.col(0) * p.x() + rotation.col(1) * p.y() + rotation.col(2) * p.z() +
           translation;
  }
  Rigid3d Rigid() const { return {Eigen::Quaterniond(rotation).normalized(), translation}; }
};

MatrixPose MatrixOf(const Rigid3d& pose) {
  return {pose.rotation.toRotationMatrix(), pose.translation};
}

/// Pairs of one kind of a problem, with residuals in their sigmas.
class Pairs {
 public:
  Pairs(const CalibrationProblem& problem, PairKind kind, const Camera* camera)
      : problem_(problem), kind_(kind), camera_(camera) {}

  double Squared(int index, const MatrixPose& pose) const {
    const auto i = static_cast<std::size_t>(index);
    if (kind_ == PairKind::k3d3d) {
      const Pair3d3d& pair = problem_.pairs_3d3d[i];
      const Eigen::Vector3d residual = pair.point_in_cam - pose.At(pair.point_in_lidar);
      if (pair.covariance_in_cam)
        return residual.dot(pair.covariance_in_cam->llt().solve(residual));
      return residual.squaredNorm() / Variance(pair);
    }
    const Pair2d3d& pair = problem_.pairs_2d3d[i];
    const auto projected = Project(*camera_, pose.At(pair.point_in_lidar));
    if (!projected) return std::numeric_limits<double>::infinity();
    return (pair.pixel - *projected).squaredNorm() / Variance(pair);
  }

  // Of the pairs that the answer used.
  double LargestSquared(const SolveReport& answer) const {
    double largest = 0.0;
    for (const int index : answer.inliers) {
      const auto i = static_cast<std::size_t>(index);
      if (kind_ == PairKind::k2d3d) {
        const double residual = answer.evaluation.per_pair_px[i];
        largest = std::max(largest, residual * residual / Variance(problem_.pairs_2d3d[i]));
      } else if (problem_.pairs_3d3d[i].covariance_in_cam) {
        largest = std::max(largest, Squared(index, MatrixOf(answer.cam_from_lidar)));
      } else {
        const double residual = answer.evaluation.per_pair_m[i];
        largest = std::max(largest, residual * residual / Variance(problem_.pairs_3d3d[i]));
      }
    }
    return largest;
  }

  std::vector<int> Agreeing(const std::vector<int>& among, const MatrixPose& pose,
                            double max_squared) const {
    std::vector<int> agreeing;
    for (const int i : among) {
      if (Squared(i, pose) <= max_squared) agreeing.push_back(i);
    }
    return agreeing;
  }

  // Whether most pairs agree, by a few of them: false as soon as three more contradict the pose
  // than agree, which of a pose that three of four agree on is one in 27.
  bool MostMayAgree(const std::vector<int>& among, const MatrixPose& pose,
                    double max_squared) const {
    constexpr int kLead = 3;
    int lead = 0;
    for (const int i : among) {
      lead += Squared(i, pose) <= max_squared ? -1 : 1;
      if (lead == kLead) return false;
    }
    return true;
  }

  void AddPosesOf(const Sample& sample, std::vector<MatrixPose>& poses) const {
    kind_ == PairKind::k3d3d ? AddPoseOfPoints(sample, poses) : AddPosesOfPixels(sample, poses);
  }

  std::optional<Rigid3d> LeastSquares(const std::vector<int>& used, const Rigid3d& start) const {
    const DataNeeds needs = {.pairs_3d3d = kind_ == PairKind::k3d3d ? 1 : 0};
    PairTerms terms = MakeTerms(SubsetOf(problem_, needs, used), kind_);
    if (camera_ != nullptr) terms.camera = *camera_;
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
      for (const Pair3d3d& pair : problem_.pairs_3d3d) box.extend(pair.point_in_cam);
      const double r = radius * LargestSigma(problem_.pairs_3d3d.front());
      const Eigen::Array3d sides = box.sizes().array() + 2.0 * r;
      return std::min(1.0, 4.0 / 3.0 * std::numbers::pi * r * r * r / sides.prod());
    }
    Eigen::AlignedBox2d box;
    for (const Pair2d3d& pair : problem_.pairs_2d3d) box.extend(pair.pixel);
    const double r = radius * std::sqrt(Variance(problem_.pairs_2d3d.front()));
    const Eigen::Array2d sides = box.sizes().array() + 2.0 * r;
    return std::min(1.0, std::numbers::pi * r * r / sides.prod());
  }

 private:
  static double LargestSigma(const Pair3d3d& pair) {
    return std::sqrt(pair.covariance_in_cam ? pair.covariance_in_cam->trace() : Variance(pair));
  }

  void AddPoseOfPoints(const Sample& sample, std::vector<MatrixPose>& poses) const {
    std::array<Eigen::Vector3d, kSampleSize> in_cam;
    std::array<Eigen::Vector3d, kSampleSize> in_lidar;
    for (std::size_t i = 0; i < kSampleSize; ++i) {
      const Pair3d3d& pair = problem_.pairs_3d3d[static_cast<std::size_t>(sample[i])];
      in_cam[i] = pair.point_in_cam;
      in_lidar[i] = pair.point_in_lidar;
    }
    const KabschOutcome fit = FitPoints(in_cam, in_lidar, {});
    if (fit) poses.push_back(MatrixOf(fit->b_from_a));
  }

  void AddPosesOfPixels(const Sample& sample, std::vector<MatrixPose>& poses) const {
    std::array<Eigen::Vector3d, kSampleSize> rays;
    std::array<Eigen::Vector3d, kSampleSize> points;
    for (std::size_t i = 0; i < kSampleSize; ++i) {
      const Pair2d3d& pair = problem_.pairs_2d3d[static_cast<std::size_t>(sample[i])];
      const std::optional<Eigen::Vector3d> ray = Unproject(*camera_, pair.pixel);
      if (!ray) return;
      rays[i] = ray->normalized();
      points[i] = pair.point_in_lidar;
    }
    std::array<Rigid3d, kMaxP3pPoses> found;
    const int count = SolveP3p(rays, points, found);
    for (int i = 0; i < count; ++i) poses.push_back(MatrixOf(found[static_cast<std::size_t>(i)]));
  }

  const CalibrationProblem& problem_;
  PairKind kind_;
  const Camera* camera_;
};

Sample DrawFrom(const std::vector<int>& among, Random& random) {
  const auto draw = [&] { return among[random.Below(among.size())]; };
  Sample sample{};
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

Consensus SearchAmong(const std::vector<int>& among, const Pairs& pairs, double max_squared,
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
  for (int refit = 0; refit < kMaxRefits && best.agreeing.size() > kSampleSize; ++refit) {
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
      kSampleSize + 1,
      static_cast<std::size_t>(std::ceil(kRivalShare * static_cast<double>(used))));
  if (used == 0 || count < used + wanted) return {};
  const double samples = SamplesFor(count - used, wanted);
  if (samples > kMaxSamples) return {};

  const Camera* camera = answer.camera    ? &answer.camera->camera
                         : problem.camera ? &*problem.camera
                                          : nullptr;
  const Pairs pairs(problem, kind, camera);
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
