// SPDX-License-Identifier: Apache-2.0
#include "solvers/icp/icp.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/pair_noise.h"
#include "solvers/icp/point_to_plane.h"
#include "solvers/icp/point_tree.h"
#include "solvers/kernels/kabsch.h"

namespace sextant {
namespace {

using PointSpan = std::span<const Eigen::Vector3d>;

std::size_t Place(int i) { return static_cast<std::size_t>(i); }

// Finds and trims the matches. Keeps its buffers between iterations to save allocations.
class ClosestPoints {
 public:
  ClosestPoints(const PointTree& tree, PointSpan source, const IcpSettings& settings)
      : tree_(tree), source_(source), trim_(settings.trim), nearest_(source.size(), -1) {
    if (settings.max_distance_m > 0.0) closer_than_m2_ = std::pow(settings.max_distance_m, 2);
    matches_.reserve(source.size());
  }

  const std::vector<IcpMatch>& Match(const Rigid3d& target_from_source) {
    const Eigen::Matrix3d rotation = target_from_source.rotation.toRotationMatrix();
    matches_.clear();
    for (std::size_t i = 0; i < source_.size(); ++i) {
      const Eigen::Vector3d moved = rotation * source_[i] + target_from_source.translation;
      const PointTree::Neighbour found = tree_.Nearest(moved, closer_than_m2_, nearest_[i]);
      if (found.index < 0) continue;
      nearest_[i] = found.index;
      matches_.push_back({static_cast<int>(i), found.index, found.squared_distance_m2});
    }
    if (trim_ > 0.0 && !matches_.empty()) Trim();
    return matches_;
  }

 private:
  // Keeps the order by source, and all matches with the same distance as the worst one kept.
  void Trim() {
    distances_.clear();
    for (const IcpMatch& match : matches_) distances_.push_back(match.squared_distance_m2);
    const double kept = std::ceil((1.0 - trim_) * static_cast<double>(matches_.size()));
    const auto last = distances_.begin() + std::max<std::ptrdiff_t>(0, std::lround(kept) - 1);
    std::nth_element(distances_.begin(), last, distances_.end());
    std::erase_if(matches_,
                  [worst = *last](const IcpMatch& m) { return m.squared_distance_m2 > worst; });
  }

  const PointTree& tree_;
  PointSpan source_;
  double trim_;
  double closer_than_m2_ = std::numeric_limits<double>::infinity();
  std::vector<int> nearest_;  // Last match of each source point.
  std::vector<IcpMatch> matches_;
  std::vector<double> distances_;
};

// A metric: sets the matches of an iteration, computes its pose, and after the last one the
// statistics.
class PointMetric {
 public:
  static constexpr std::size_t kMinMatches = 3;

  PointMetric(PointSpan target, PointSpan source) : target_(target), source_(source) {
    matched_target_.reserve(source.size());
    matched_source_.reserve(source.size());
  }

  void SetMatches(const std::vector<IcpMatch>& matches) {
    matched_target_.clear();
    matched_source_.clear();
    for (const IcpMatch& match : matches) {
      matched_target_.push_back(target_[Place(match.target)]);
      matched_source_.push_back(source_[Place(match.source)]);
    }
  }

  std::size_t size() const { return matched_source_.size(); }

  Expected<Rigid3d> Step(const Rigid3d& /*pose*/) const {
    return FitKabsch(matched_target_, matched_source_).map([](const KabschFit& fit) {
      return fit.b_from_a;
    });
  }

  void Finish(IcpFit& fit) const {
    std::vector<Pair3d3d> pairs(size());
    double squares = 0.0;
    for (std::size_t i = 0; i < size(); ++i) {
      pairs[i].point_in_cam = matched_target_[i];
      pairs[i].point_in_lidar = matched_source_[i];
      squares += (matched_target_[i] - fit.target_from_source * matched_source_[i]).squaredNorm();
    }
    fit.rmse_m = std::sqrt(squares / static_cast<double>(size()));
    fit.covariance =
        PropagateCovariance(pairs, std::vector<double>(size(), 1.0), fit.target_from_source);
  }

 private:
  PointSpan target_;
  PointSpan source_;
  std::vector<Eigen::Vector3d> matched_target_;
  std::vector<Eigen::Vector3d> matched_source_;
};

class PlaneMetric {
 public:
  static constexpr std::size_t kMinMatches = 6;

  PlaneMetric(PointSpan target, PointSpan source, const PointTree& tree, int neighbours)
      : target_(target), source_(source), normals_(target, tree, neighbours) {
    matches_.reserve(source.size());
  }

  void SetMatches(const std::vector<IcpMatch>& matches) {
    matches_.clear();
    for (const IcpMatch& match : matches) {
      const Eigen::Vector3d& normal = normals_[Place(match.target)];
      if (normal.isZero(0.0)) continue;
      matches_.push_back({source_[Place(match.source)], target_[Place(match.target)], normal});
    }
  }

  std::size_t size() const { return matches_.size(); }
  Expected<Rigid3d> Step(const Rigid3d& pose) const { return StepToPlanes(matches_, pose); }

  void Finish(IcpFit& fit) const {
    fit.rmse_m = RmseToPlanes(matches_, fit.target_from_source);
    fit.covariance = PlaneCovariance(matches_, fit.target_from_source);
  }

 private:
  PointSpan target_;
  PointSpan source_;
  SurfaceNormals normals_;
  std::vector<PlaneMatch> matches_;
};

tl::unexpected<Error> ExplainStep(const Error& error, int iteration) {
  if (error.code == ErrorCode::kMirrored) {
    return MakeError(ErrorCode::kNoConsensus,
                     fmt::format("icp, iteration {}: the matches look like a mirror image; the "
                                 "start is too far off, give a better one",
                                 iteration));
  }
  return MakeError(error.code, fmt::format("icp, iteration {}: {}", iteration, error.message));
}

template <class Metric>
Expected<IcpFit> Iterate(ClosestPoints& matcher, Metric& metric, const Rigid3d& start,
                         const IcpSettings& settings) {
  IcpFit fit;
  fit.target_from_source = start;
  const std::vector<IcpMatch>* matches = nullptr;
  while (!fit.converged && fit.iterations < settings.max_iterations) {
    ++fit.iterations;
    matches = &matcher.Match(fit.target_from_source);
    metric.SetMatches(*matches);
    if (metric.size() < Metric::kMinMatches) {
      return MakeError(
          ErrorCode::kNoConsensus,
          fmt::format("icp, iteration {}: {} usable matches, expected {} or more; give a better "
                      "start, or raise max_distance_m or lower trim",
                      fit.iterations, metric.size(), Metric::kMinMatches));
    }
    const Expected<Rigid3d> pose = metric.Step(fit.target_from_source);
    if (!pose) return ExplainStep(pose.error(), fit.iterations);
    const Vector6d step = PoseDifference(*pose, fit.target_from_source);
    fit.target_from_source = *pose;
    fit.converged = step.head<3>().norm() <= settings.rotation_tolerance_rad &&
                    step.tail<3>().norm() <= settings.translation_tolerance_m;
  }
  fit.matches = *matches;
  metric.Finish(fit);
  return fit;
}

}  // namespace

Expected<IcpFit> FitIcp(PointSpan target, PointSpan source, const Rigid3d& start,
                        const IcpSettings& settings) {
  const bool planes = settings.metric == IcpMetric::kPlane;
  const std::size_t least_target = planes ? std::max(Place(settings.neighbours), 3UL) : 3UL;
  const std::size_t least_source = planes ? PlaneMetric::kMinMatches : PointMetric::kMinMatches;
  if (target.size() < least_target || source.size() < least_source) {
    return MakeError(
        ErrorCode::kTooFewPairs,
        fmt::format("icp needs at least {} points in the camera frame and {} in the LiDAR frame, "
                    "got {} and {}{}",
                    least_target, least_source, target.size(), source.size(),
                    planes ? "; metric=plane fits normals to `neighbours` points, metric=point "
                             "needs only 3"
                           : ""));
  }
  const PointTree tree(target);
  ClosestPoints matcher(tree, source, settings);
  if (planes) {
    PlaneMetric metric(target, source, tree, settings.neighbours);
    return Iterate(matcher, metric, start, settings);
  }
  PointMetric metric(target, source);
  return Iterate(matcher, metric, start, settings);
}

Rigid3d AlignCentroids(PointSpan target, PointSpan source) {
  const auto mean = [](PointSpan points) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& point : points) sum += point;
    return Eigen::Vector3d(sum / static_cast<double>(points.size()));
  };
  return {Eigen::Quaterniond::Identity(), mean(target) - mean(source)};
}

}  // namespace sextant
