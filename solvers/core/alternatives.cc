// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/alternatives.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "geometry/symmetric.h"
#include "solvers/core/mirror_image.h"
#include "solvers/kernels/p3p.h"
#include "solvers/kernels/pair_terms.h"
#include "solvers/least_squares/refine_pose.h"

namespace sextant {
namespace {

// Up to this many points each triple's poses are candidates: their minima need not be mirror
// images.
constexpr std::size_t kMaxForTriples = 5;

// Two poses closer than this are one.
constexpr double kSameRotation = 1e-3;

struct Minimum {
  Rigid3d pose;
  double squares = 0.0;
  bool of_answer = false;
};

std::vector<Pair2d3d> PixelsOf(const CalibrationProblem& problem, std::span<const int> indices) {
  std::vector<Pair2d3d> pairs;
  pairs.reserve(indices.size());
  for (const int i : indices) pairs.push_back(problem.pairs_2d3d[static_cast<std::size_t>(i)]);
  return pairs;
}

// Centre and scatter of points that a rotation may mirror.
struct Shape {
  Eigen::Vector3d centre;
  Eigen::Matrix3d scatter;

  // In one pass without a copy, as every solver of pixels does it.
  Shape(std::span<const Pair2d3d> pairs, std::span<const int> indices) {
    const Eigen::Vector3d& origin = pairs[static_cast<std::size_t>(indices.front())].point_in_lidar;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0;
    for (const int i : indices) {
      const Eigen::Vector3d arm = pairs[static_cast<std::size_t>(i)].point_in_lidar - origin;
      sum += arm;
      xx += arm.x() * arm.x();
      yy += arm.y() * arm.y();
      zz += arm.z() * arm.z();
      xy += arm.x() * arm.y();
      xz += arm.x() * arm.z();
      yz += arm.y() * arm.z();
    }
    Eigen::Matrix3d products;
    products << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    const auto count = static_cast<double>(indices.size());
    centre = origin + sum / count;
    scatter = products / count - sum * sum.transpose() / (count * count);
  }

  // Whether the smallest variance is under about 2 percent of the sum, so that the thickness does
  // not decide between a pose and its mirror image whatever the noise.
  bool IsThin() const {
    constexpr double kThin = 0.02;
    const double minors =
        0.5 * (scatter.trace() * scatter.trace() - scatter.cwiseProduct(scatter).sum());
    return !(scatter.determinant() > kThin * scatter.trace() * minors);
  }
};

Rigid3d MirrorImage(const Shape& shape, const Rigid3d& pose) {
  const Eigen::Vector3d normal = EigenOf(shape.scatter).vectors.col(0);
  const Eigen::Vector3d centre = pose * shape.centre;
  Rigid3d mirrored;
  mirrored.rotation = Eigen::Quaterniond(MirroredRotation(pose.rotation.toRotationMatrix(), normal,
                                                          centre.normalized()))
                          .normalized();
  mirrored.translation = centre - mirrored.rotation * shape.centre;
  return mirrored;
}

void AddPosesOfTriples(const Camera& camera, std::span<const Pair2d3d> pairs,
                       std::vector<Rigid3d>& candidates) {
  std::vector<Eigen::Vector3d> rays;
  for (const Pair2d3d& pair : pairs) {
    const std::optional<Eigen::Vector3d> ray = Unproject(camera, pair.pixel);
    if (!ray) return;
    rays.push_back(*ray);
  }
  std::array<Rigid3d, kMaxP3pPoses> poses;
  for (std::size_t a = 0; a < pairs.size(); ++a) {
    for (std::size_t b = a + 1; b < pairs.size(); ++b) {
      for (std::size_t c = b + 1; c < pairs.size(); ++c) {
        const std::array<Eigen::Vector3d, 3> of_rays = {rays[a], rays[b], rays[c]};
        const std::array<Eigen::Vector3d, 3> points = {
            pairs[a].point_in_lidar, pairs[b].point_in_lidar, pairs[c].point_in_lidar};
        const int count = SolveP3p(of_rays, points, poses);
        candidates.insert(candidates.end(), poses.begin(), poses.begin() + count);
      }
    }
  }
}

/// The different minima that candidates lead to.
class Minima {
 public:
  explicit Minima(const PairTerms& terms) : terms_(terms) {}

  void SearchFrom(const Rigid3d& start, bool of_answer) {
    constexpr RefineLimits kLimits = {.max_iterations = 100, .step_tolerance = 1e-10};
    const RefinedPose refined = RefinePose(terms_.View(), start, kLimits);
    const bool settled =
        refined.outcome == RefineOutcome::kConverged || refined.outcome == RefineOutcome::kStalled;
    if (!settled || !refined.cam_from_lidar.IsFinite()) return;
    const Minimum minimum = {refined.cam_from_lidar, 2.0 * refined.cost, of_answer};
    for (const Minimum& other : found_) {
      if (RotationDistance(other.pose.rotation, minimum.pose.rotation) < kSameRotation) return;
    }
    found_.push_back(minimum);
  }

  /// Those likely in comparison with the best, best first; of equal ones that of the answer.
  std::vector<Minimum> Likely() {
    const double rounding = Rounding();
    std::stable_sort(found_.begin(), found_.end(), [&](const Minimum& a, const Minimum& b) {
      return a.squares + rounding < (1.0 - 1e-9) * b.squares;
    });
    const auto unlikely = [&](const Minimum& minimum) {
      return !IsLikely(minimum.squares, found_.front().squares, rounding);
    };
    std::vector<Minimum> likely = found_;
    std::erase_if(likely, unlikely);
    return likely;
  }

 private:
  // The sum of squares of exact pixels, whose errors are below 1e-9 of the focal length.
  double Rounding() const {
    double sum = 0.0;
    for (const PixelTerm& term : terms_.pixels) {
      const double error = 1e-9 * terms_.camera.fx_px * term.inverse_sigma;
      sum += 2.0 * error * error;
    }
    return sum;
  }

  bool IsLikely(double squares, double least, double rounding) const {
    const double freedom = 2.0 * static_cast<double>(terms_.pixels.size()) - 6.0;
    const double log_ratio = std::log(kMaxLikelihoodRatio);
    if (!terms_.noise_known) {
      if (freedom <= 0.0) return squares <= rounding;
      return squares + rounding <= (least + rounding) * std::exp(2.0 * log_ratio / freedom);
    }
    const double variance = freedom > 0.0 ? std::max(1.0, least / freedom) : 1.0;
    return squares - least <= 2.0 * log_ratio * variance + rounding;
  }

  const PairTerms& terms_;
  std::vector<Minimum> found_;
};

}  // namespace

LikelyPoses FindLikelyPoses(const CalibrationProblem& problem, const SolverSpec& spec,
                            const Estimate& answer) {
  constexpr std::size_t kMinPairs = 3;
  const bool of_pixels = spec.needs.pairs_2d3d > 0 && spec.needs.pairs_3d3d == 0;
  if (!of_pixels || !FindsWholePose(spec) || answer.inliers.size() < kMinPairs) {
    return {};
  }
  const Shape shape(problem.pairs_2d3d, answer.inliers);
  const bool is_thin = shape.IsThin();
  const bool are_few = answer.inliers.size() <= kMaxForTriples;
  if (!is_thin && !are_few && answer.alternatives.empty()) return {};

  const std::vector<Pair2d3d> pairs = PixelsOf(problem, answer.inliers);
  const Camera& camera = answer.camera ? answer.camera->camera : *problem.camera;
  std::vector<Rigid3d> candidates = answer.alternatives;
  if (is_thin) candidates.push_back(MirrorImage(shape, answer.cam_from_lidar));
  if (are_few) AddPosesOfTriples(camera, pairs, candidates);
  PairTerms terms;
  terms.Add(pairs, camera);
  Minima minima(terms);
  minima.SearchFrom(answer.cam_from_lidar, true);
  for (const Rigid3d& candidate : candidates) minima.SearchFrom(candidate, false);
  LikelyPoses likely;
  for (const Minimum& minimum : minima.Likely()) {
    if (minimum.of_answer) likely.of_answer = likely.poses.size();
    likely.poses.push_back(minimum.pose);
  }
  return likely;
}

}  // namespace sextant
