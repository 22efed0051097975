// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/sampled_pairs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/pair_noise.h"
#include "geometry/residuals.h"
#include "solvers/core/subset.h"
#include "solvers/kernels/kabsch_fit.h"
#include "solvers/kernels/p3p.h"
#include "solvers/kernels/pair_terms.h"
#include "solvers/least_squares/refine_pose.h"

namespace sextant {
namespace {

double Variance(const Pair3d3d& pair) {
  return HasKnownNoise(pair) ? pair.sigma_m * pair.sigma_m : 1.0;
}
double Variance(const Pair2d3d& pair) {
  return HasKnownNoise(pair) ? pair.sigma_px * pair.sigma_px : 1.0;
}

double LargestSigma(const Pair3d3d& pair) {
  return std::sqrt(pair.covariance_in_cam ? pair.covariance_in_cam->trace() : Variance(pair));
}

}  // namespace

Eigen::Vector3d MatrixPose::At(const Eigen::Vector3d& p) const {
  return rotation.col(0) * p.x() + rotation.col(1) * p.y() + rotation.col(2) * p.z() + translation;
}

Rigid3d MatrixPose::Rigid() const {
  return {Eigen::Quaterniond(rotation).normalized(), translation};
}

MatrixPose MatrixOf(const Rigid3d& pose) {
  return {pose.rotation.toRotationMatrix(), pose.translation};
}

double SampledPairs::Squared(int index, const MatrixPose& pose) const {
  const auto i = static_cast<std::size_t>(index);
  if (kind_ == PairKind::k3d3d) {
    const Pair3d3d& pair = problem_.pairs_3d3d[i];
    const Eigen::Vector3d residual = pair.point_in_cam - pose.At(pair.point_in_lidar);
    if (pair.covariance_in_cam) return residual.dot(pair.covariance_in_cam->llt().solve(residual));
    return residual.squaredNorm() / Variance(pair);
  }
  const Pair2d3d& pair = problem_.pairs_2d3d[i];
  const auto projected = Project(*camera_, pose.At(pair.point_in_lidar));
  if (!projected) return std::numeric_limits<double>::infinity();
  return (pair.pixel - *projected).squaredNorm() / Variance(pair);
}

double SampledPairs::LargestSquared(const SolveReport& answer) const {
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

std::vector<int> SampledPairs::Agreeing(const std::vector<int>& among, const MatrixPose& pose,
                                        double max_squared) const {
  std::vector<int> agreeing;
  for (const int i : among) {
    if (Squared(i, pose) <= max_squared) agreeing.push_back(i);
  }
  return agreeing;
}

bool SampledPairs::MostMayAgree(const std::vector<int>& among, const MatrixPose& pose,
                                double max_squared) const {
  constexpr int kLead = 3;
  int lead = 0;
  for (const int i : among) {
    lead += Squared(i, pose) <= max_squared ? -1 : 1;
    if (lead == kLead) return false;
  }
  return true;
}

void SampledPairs::AddPosesOf(const PairTriple& sample, std::vector<MatrixPose>& poses) const {
  kind_ == PairKind::k3d3d ? AddPoseOfPoints(sample, poses) : AddPosesOfPixels(sample, poses);
}

std::optional<Rigid3d> SampledPairs::LeastSquares(const std::vector<int>& used,
                                                  const Rigid3d& start) const {
  const DataNeeds needs = {.pairs_3d3d = kind_ == PairKind::k3d3d ? 1 : 0};
  PairTerms terms = MakeTerms(SubsetOf(problem_, needs, used), kind_);
  if (camera_ != nullptr) terms.camera = *camera_;
  const RefinedPose refined = RefinePose(terms.View(), start, {.wants_information = false});
  if (refined.outcome == RefineOutcome::kNotProjected) return std::nullopt;
  return refined.cam_from_lidar;
}

double SampledPairs::ChanceOfOne(double max_squared) const {
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

void SampledPairs::AddPoseOfPoints(const PairTriple& sample, std::vector<MatrixPose>& poses) const {
  std::array<Eigen::Vector3d, kPairTriple> in_cam;
  std::array<Eigen::Vector3d, kPairTriple> in_lidar;
  for (std::size_t i = 0; i < kPairTriple; ++i) {
    const Pair3d3d& pair = problem_.pairs_3d3d[static_cast<std::size_t>(sample[i])];
    in_cam[i] = pair.point_in_cam;
    in_lidar[i] = pair.point_in_lidar;
  }
  const KabschOutcome fit = FitPoints(in_cam, in_lidar, {});
  if (fit) poses.push_back(MatrixOf(fit->b_from_a));
}

void SampledPairs::AddPosesOfPixels(const PairTriple& sample,
                                    std::vector<MatrixPose>& poses) const {
  std::array<Eigen::Vector3d, kPairTriple> rays;
  std::array<Eigen::Vector3d, kPairTriple> points;
  for (std::size_t i = 0; i < kPairTriple; ++i) {
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

}  // namespace sextant
