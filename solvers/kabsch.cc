// SPDX-License-Identifier: Apache-2.0
#include "solvers/kabsch.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "solvers/pair_noise.h"
#include "solvers/registry.h"

namespace sextant {
namespace {

// Points within 1e-5 of their length of a line leave the turn about it to rounding.
constexpr double kMinRelativeGap = 1e-10;

// Five in RMSE: noise on four coplanar points reaches this less than once in a thousand.
constexpr double kMirrorRatio = 25.0;

struct CentredMoments {
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_b = Eigen::Vector3d::Zero();
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();  // sum w (a - mean_a) (b - mean_b)^T
  double squares_a = 0.0;
  double squares_b = 0.0;
};

CentredMoments ComputeMoments(std::span<const Eigen::Vector3d> b,
                              std::span<const Eigen::Vector3d> a, std::span<const double> weights) {
  CentredMoments m;
  // The first point as provisional origin keeps the digits of small sets far from the sensor.
  const Eigen::Vector3d origin_a = a[0];
  const Eigen::Vector3d origin_b = b[0];
  double total = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double w = weights.empty() ? 1.0 : weights[i];
    const Eigen::Vector3d da = a[i] - origin_a;
    const Eigen::Vector3d db = b[i] - origin_b;
    total += w;
    m.mean_a += w * da;
    m.mean_b += w * db;
    m.cross += (w * da) * db.transpose();
    m.squares_a += w * da.squaredNorm();
    m.squares_b += w * db.squaredNorm();
  }
  m.cross -= m.mean_a * m.mean_b.transpose() / total;
  m.squares_a -= m.mean_a.squaredNorm() / total;
  m.squares_b -= m.mean_b.squaredNorm() / total;
  m.mean_a = origin_a + m.mean_a / total;
  m.mean_b = origin_b + m.mean_b / total;
  return m;
}

// Horn's matrix: q^T K q = trace(R(q) * cross) for q = (x, y, z, w).
Eigen::Matrix4d HornMatrix(const Eigen::Matrix3d& cross) {
  Eigen::Matrix4d k;
  k.topLeftCorner<3, 3>() = cross + cross.transpose() - cross.trace() * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d skew(cross(1, 2) - cross(2, 1), cross(2, 0) - cross(0, 2),
                             cross(0, 1) - cross(1, 0));
  k.topRightCorner<3, 1>() = skew;
  k.bottomLeftCorner<1, 3>() = skew.transpose();
  k(3, 3) = cross.trace();
  return k;
}

}  // namespace

Expected<KabschFit> FitKabsch(std::span<const Eigen::Vector3d> points_in_b,
                              std::span<const Eigen::Vector3d> points_in_a,
                              std::span<const double> weights) {
  if (points_in_a.size() < 3) {
    return MakeError(ErrorCode::kTooFewPairs,
                     fmt::format("kabsch needs at least 3 pairs, got {}", points_in_a.size()));
  }
  const CentredMoments m = ComputeMoments(points_in_b, points_in_a, weights);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(HornMatrix(m.cross));
  const Eigen::Vector4d& lambda = eigen.eigenvalues();
  const double squares = m.squares_a + m.squares_b;
  if (!(lambda(3) - lambda(2) > kMinRelativeGap * 0.5 * squares)) {
    return MakeError(ErrorCode::kDegenerate,
                     "the points of a sensor coincide or lie on one line, which leaves a rotation "
                     "undetermined; use points that span a plane");
  }
  KabschFit fit;
  fit.sum_squares = std::max(0.0, squares - 2.0 * lambda(3));
  fit.mirrored_sum_squares = std::max(0.0, squares + 2.0 * lambda(0));
  if (fit.sum_squares > kMirrorRatio * fit.mirrored_sum_squares + 1e-9 * squares) {
    return MakeError(ErrorCode::kMirrored,
                     "one point set is a mirror image of the other: no rotation maps them; check "
                     "the order of the corners and the sign of the axes");
  }
  fit.b_from_a.rotation = Eigen::Quaterniond(eigen.eigenvectors().col(3)).normalized();
  fit.b_from_a.translation = m.mean_b - fit.b_from_a.rotation * m.mean_a;
  return fit;
}

namespace {

struct GatheredPairs {
  std::vector<Eigen::Vector3d> in_cam;
  std::vector<Eigen::Vector3d> in_lidar;
};

GatheredPairs Gather(std::span<const Pair3d3d> pairs) {
  GatheredPairs points;
  points.in_cam.reserve(pairs.size());
  points.in_lidar.reserve(pairs.size());
  for (const Pair3d3d& pair : pairs) {
    points.in_cam.push_back(pair.point_in_cam);
    points.in_lidar.push_back(pair.point_in_lidar);
  }
  return points;
}

class KabschSolver final : public Solver {
 public:
  explicit KabschSolver(const std::string& name)
      : Solver({.name = name, .needs = {.pairs_3d3d = 3}}) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    const GatheredPairs points = Gather(problem.pairs_3d3d);
    const std::vector<double> weights = IsotropicWeights(problem.pairs_3d3d);
    const Expected<KabschFit> fit = FitKabsch(points.in_cam, points.in_lidar, weights);
    if (!fit) return tl::unexpected<Error>(fit.error());
    Estimate estimate;
    estimate.cam_from_lidar = fit->b_from_a;
    estimate.inliers.resize(problem.pairs_3d3d.size());
    std::iota(estimate.inliers.begin(), estimate.inliers.end(), 0);
    estimate.covariance = PropagateCovariance(problem.pairs_3d3d, weights, fit->b_from_a);
    return estimate;
  }

  void DoHypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                     std::vector<Rigid3d>& poses) const override {
    constexpr std::size_t kMostOnStack = 64;
    if (sample.size() > kMostOnStack) return;
    std::array<Eigen::Vector3d, kMostOnStack> in_cam;
    std::array<Eigen::Vector3d, kMostOnStack> in_lidar;
    for (std::size_t i = 0; i < sample.size(); ++i) {
      const Pair3d3d& pair = problem.pairs_3d3d[static_cast<std::size_t>(sample[i])];
      in_cam[i] = pair.point_in_cam;
      in_lidar[i] = pair.point_in_lidar;
    }
    const Expected<KabschFit> fit =
        FitKabsch(std::span(in_cam).first(sample.size()), std::span(in_lidar).first(sample.size()));
    if (fit) poses.push_back(fit->b_from_a);
  }
};

}  // namespace

SolverEntry KabschEntry() {
  return {
      .name = "kabsch",
      .summary = "least squares of the 3D distances in closed form, weighted by 1/sigma^2",
      .needs = "3 or more 3D-3D pairs, not on one line",
      .reference = "Kabsch 1976; Horn 1987 (quaternion form); eq. 12 to 18 of the paper",
      .example = "kabsch",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return std::make_shared<KabschSolver>(arguments.name);
      },
  };
}

}  // namespace sextant
