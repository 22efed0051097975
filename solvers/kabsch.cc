// SPDX-License-Identifier: Apache-2.0
#include "solvers/kabsch.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "solvers/max_trace_rotation.h"
#include "solvers/pair_noise.h"
#include "solvers/registry.h"

namespace sextant {
namespace {

// Five in RMSE: noise on four coplanar points reaches this less than once in a thousand.
constexpr double kMirrorRatio = 25.0;

// Two points at a time: what the SIMD registers of every 64-bit machine hold.
using Lanes = Eigen::Array2d;

struct Lanes3 {
  Lanes x, y, z;
};

struct CentredMoments {
  Eigen::Vector3d mean_a;
  Eigen::Vector3d mean_b;
  Eigen::Matrix3d cross;  // sum w (a - mean_a) (b - mean_b)^T
  double squares = 0.0;   // sum w (|a - mean_a|^2 + |b - mean_b|^2)
};

Lanes3 Offsets(const Eigen::Vector3d& first, const Eigen::Vector3d& second,
               const Eigen::Vector3d& origin) {
  return {Lanes(first.x(), second.x()) - origin.x(), Lanes(first.y(), second.y()) - origin.y(),
          Lanes(first.z(), second.z()) - origin.z()};
}

// Points as the caller holds them, so that none need be copied: size(), a(i), b(i).
struct PointSpans {
  std::size_t size() const { return in_a.size(); }
  const Eigen::Vector3d& a(std::size_t i) const { return in_a[i]; }
  const Eigen::Vector3d& b(std::size_t i) const { return in_b[i]; }

  std::span<const Eigen::Vector3d> in_b;
  std::span<const Eigen::Vector3d> in_a;
};

struct AllPairs {
  std::size_t size() const { return pairs.size(); }
  const Eigen::Vector3d& a(std::size_t i) const { return pairs[i].point_in_lidar; }
  const Eigen::Vector3d& b(std::size_t i) const { return pairs[i].point_in_cam; }

  std::span<const Pair3d3d> pairs;
};

struct SampledPairs {
  std::size_t size() const { return sample.size(); }
  const Eigen::Vector3d& a(std::size_t i) const { return pair(i).point_in_lidar; }
  const Eigen::Vector3d& b(std::size_t i) const { return pair(i).point_in_cam; }
  const Pair3d3d& pair(std::size_t i) const { return pairs[static_cast<std::size_t>(sample[i])]; }

  std::span<const Pair3d3d> pairs;
  std::span<const int> sample;
};

template <bool kWeighted, class Points>
CentredMoments ComputeMoments(const Points& points, std::span<const double> weights) {
  // The first point as provisional origin keeps the digits of small sets far from the sensor.
  const Eigen::Vector3d origin_a = points.a(0);
  const Eigen::Vector3d origin_b = points.b(0);
  const std::size_t count = points.size();
  Lanes total = Lanes::Zero();
  Lanes squares = Lanes::Zero();
  Lanes ax = Lanes::Zero(), ay = Lanes::Zero(), az = Lanes::Zero();
  Lanes bx = Lanes::Zero(), by = Lanes::Zero(), bz = Lanes::Zero();
  Lanes xx = Lanes::Zero(), xy = Lanes::Zero(), xz = Lanes::Zero();
  Lanes yx = Lanes::Zero(), yy = Lanes::Zero(), yz = Lanes::Zero();
  Lanes zx = Lanes::Zero(), zy = Lanes::Zero(), zz = Lanes::Zero();
  // An odd count leaves out the first point: it is the origin and adds to the total only.
  for (std::size_t i = count % 2; i < count; i += 2) {
    const Lanes3 a = Offsets(points.a(i), points.a(i + 1), origin_a);
    Lanes3 b = Offsets(points.b(i), points.b(i + 1), origin_b);
    Lanes both = a.x * a.x + a.y * a.y + a.z * a.z + (b.x * b.x + b.y * b.y + b.z * b.z);
    if constexpr (kWeighted) {
      const Lanes w(weights[i], weights[i + 1]);
      total += w;
      both *= w;
      ax += w * a.x, ay += w * a.y, az += w * a.z;
      b = {w * b.x, w * b.y, w * b.z};
    } else {
      ax += a.x, ay += a.y, az += a.z;
    }
    squares += both;
    bx += b.x, by += b.y, bz += b.z;
    xx += a.x * b.x, xy += a.x * b.y, xz += a.x * b.z;
    yx += a.y * b.x, yy += a.y * b.y, yz += a.y * b.z;
    zx += a.z * b.x, zy += a.z * b.y, zz += a.z * b.z;
  }
  const double first = kWeighted && count % 2 == 1 ? weights[0] : 0.0;
  const double inverse_total = 1.0 / (kWeighted ? first + total.sum() : static_cast<double>(count));
  const Eigen::Vector3d sum_a(ax.sum(), ay.sum(), az.sum());
  const Eigen::Vector3d sum_b(bx.sum(), by.sum(), bz.sum());
  const Eigen::Vector3d mean_a = sum_a * inverse_total;
  const Eigen::Vector3d mean_b = sum_b * inverse_total;
  CentredMoments m;
  m.cross(0, 0) = xx.sum() - mean_a.x() * sum_b.x();
  m.cross(0, 1) = xy.sum() - mean_a.x() * sum_b.y();
  m.cross(0, 2) = xz.sum() - mean_a.x() * sum_b.z();
  m.cross(1, 0) = yx.sum() - mean_a.y() * sum_b.x();
  m.cross(1, 1) = yy.sum() - mean_a.y() * sum_b.y();
  m.cross(1, 2) = yz.sum() - mean_a.y() * sum_b.z();
  m.cross(2, 0) = zx.sum() - mean_a.z() * sum_b.x();
  m.cross(2, 1) = zy.sum() - mean_a.z() * sum_b.y();
  m.cross(2, 2) = zz.sum() - mean_a.z() * sum_b.z();
  m.squares = squares.sum() - mean_a.dot(sum_a) - mean_b.dot(sum_b);
  m.mean_a = origin_a + mean_a;
  m.mean_b = origin_b + mean_b;
  return m;
}

// Without messages: a consensus search discards most failures unread.
template <class Points>
tl::expected<KabschFit, ErrorCode> Fit(const Points& points, std::span<const double> weights) {
  if (points.size() < 3) return tl::unexpected(ErrorCode::kTooFewPairs);
  const CentredMoments m = weights.empty() ? ComputeMoments<false>(points, weights)
                                           : ComputeMoments<true>(points, weights);
  const std::optional<MaxTraceRotation> best = MaximizeTrace(m.cross, 0.5 * m.squares);
  if (!best) return tl::unexpected(ErrorCode::kDegenerate);
  KabschFit fit;
  fit.sum_squares = std::max(0.0, m.squares - 2.0 * best->trace);
  fit.mirrored_sum_squares = std::max(0.0, m.squares - 2.0 * best->mirrored_trace);
  if (fit.sum_squares > kMirrorRatio * fit.mirrored_sum_squares + 1e-9 * m.squares) {
    return tl::unexpected(ErrorCode::kMirrored);
  }
  fit.b_from_a.rotation = best->rotation;
  fit.b_from_a.translation = m.mean_b - fit.b_from_a.rotation * m.mean_a;
  return fit;
}

Error Explain(ErrorCode code, std::size_t count) {
  if (code == ErrorCode::kTooFewPairs) {
    return {code, fmt::format("kabsch needs at least 3 pairs, got {}", count)};
  }
  if (code == ErrorCode::kMirrored) {
    return {code,
            "one point set is a mirror image of the other: no rotation maps them; check the order "
            "of the corners and the sign of the axes"};
  }
  return {code,
          "the points of a sensor coincide or lie on one line, which leaves a rotation "
          "undetermined; use points that span a plane"};
}

template <class Points>
Expected<KabschFit> FitOrExplain(const Points& points, std::span<const double> weights) {
  return Fit(points, weights).map_error([&](ErrorCode code) {
    return Explain(code, points.size());
  });
}

class KabschSolver final : public Solver {
 public:
  explicit KabschSolver(const std::string& name)
      : Solver({.name = name, .needs = {.pairs_3d3d = 3}}) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    const std::vector<double> weights = IsotropicWeights(problem.pairs_3d3d);
    const Expected<KabschFit> fit = FitOrExplain(AllPairs{problem.pairs_3d3d}, weights);
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
    if (sample.size() > kMostOnStack) {
      Solver::DoHypothesize(problem, sample, poses);
      return;
    }
    std::array<double, kMostOnStack> weights;
    for (std::size_t i = 0; i < sample.size(); ++i) {
      weights[i] = IsotropicWeight(problem.pairs_3d3d[static_cast<std::size_t>(sample[i])]);
    }
    const auto fit = Fit(SampledPairs{problem.pairs_3d3d, sample},
                         std::span<const double>(weights).first(sample.size()));
    if (fit) poses.push_back(fit->b_from_a);
  }
};

}  // namespace

Expected<KabschFit> FitKabsch(std::span<const Eigen::Vector3d> points_in_b,
                              std::span<const Eigen::Vector3d> points_in_a,
                              std::span<const double> weights) {
  return FitOrExplain(PointSpans{points_in_b, points_in_a}, weights);
}

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
