// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/unexplained_pairs.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <vector>

#include "base/log_choose.h"
#include "eval/diagnostics/outlying_pairs.h"

namespace sextant {
namespace {

struct Misfit {
  double residual = 0.0;  ///< RMS, in the unit of the points.
  double spread = 0.0;    ///< RMS distance from their mean.
};

template <int kSize>
std::optional<Misfit> MisfitOf(const std::vector<Eigen::Matrix<double, kSize, 1>>& points,
                               std::span<const double> residuals, const std::vector<int>& used) {
  constexpr std::size_t kMinPairs = 4;
  if (used.size() < kMinPairs || residuals.size() != points.size()) return std::nullopt;
  Eigen::Matrix<double, kSize, 1> mean = Eigen::Matrix<double, kSize, 1>::Zero();
  for (const int i : used) mean += points[static_cast<std::size_t>(i)];
  mean /= static_cast<double>(used.size());
  double spread = 0.0;
  double unexplained = 0.0;
  for (const int i : used) {
    const auto index = static_cast<std::size_t>(i);
    spread += (points[index] - mean).squaredNorm();
    unexplained += residuals[index] * residuals[index];
  }
  if (!(spread > 0.0)) return std::nullopt;
  const auto count = static_cast<double>(used.size());
  return Misfit{std::sqrt(unexplained / count), std::sqrt(spread / count)};
}

bool IsOfOneKind(const CalibrationProblem& problem) {
  return problem.pairs_3d3d.empty() != problem.pairs_2d3d.empty();
}

const std::vector<double>& ResidualsOf(const CalibrationProblem& problem,
                                       const SolveReport& report) {
  return problem.pairs_2d3d.empty() ? report.evaluation.per_pair_m : report.evaluation.per_pair_px;
}

std::vector<Eigen::Vector3d> PointsOf(const CalibrationProblem& problem) {
  std::vector<Eigen::Vector3d> points;
  for (const Pair3d3d& pair : problem.pairs_3d3d) points.push_back(pair.point_in_cam);
  return points;
}

std::vector<Eigen::Vector2d> PixelsOf(const CalibrationProblem& problem) {
  std::vector<Eigen::Vector2d> pixels;
  for (const Pair2d3d& pair : problem.pairs_2d3d) pixels.push_back(pair.pixel);
  return pixels;
}

// The share of the box around the points, no side of which counts for less than a tenth of the
// largest, that is within `distance` of a place.
template <int kSize>
double ShareWithin(const std::vector<Eigen::Matrix<double, kSize, 1>>& points, double distance) {
  constexpr double kLeastSide = 0.1;
  Eigen::AlignedBox<double, kSize> box;
  for (const auto& point : points) box.extend(point);
  const Eigen::Matrix<double, kSize, 1> sides =
      box.sizes().cwiseMax(kLeastSide * box.sizes().maxCoeff());
  const double ball = kSize == 2 ? std::numbers::pi * distance * distance
                                 : 4.0 / 3.0 * std::numbers::pi * std::pow(distance, 3);
  return ball / sides.prod();
}

std::optional<double> ShareOf(const CalibrationProblem& problem, const SolveReport& report,
                              const std::vector<int>& used) {
  if (!IsOfOneKind(problem)) return std::nullopt;
  const std::vector<double>& residuals = ResidualsOf(problem, report);
  if (problem.pairs_2d3d.empty()) {
    const auto misfit = MisfitOf<3>(PointsOf(problem), residuals, used);
    if (!misfit) return std::nullopt;
    return misfit->residual / misfit->spread;
  }
  const auto misfit = MisfitOf<2>(PixelsOf(problem), residuals, used);
  if (!misfit) return std::nullopt;
  constexpr double kMaxSpread = 0.2;
  constexpr double kUnknowns = 6.0;
  const double numbers = 2.0 * static_cast<double>(used.size());
  const double noise_px = misfit->residual * std::sqrt(numbers / (numbers - kUnknowns));
  const double focal_px = problem.camera ? problem.camera->fx_px : misfit->spread / kMaxSpread;
  return noise_px / std::min(misfit->spread, kMaxSpread * focal_px);
}

}  // namespace

std::optional<double> UnexplainedShare(const CalibrationProblem& problem,
                                       const SolveReport& report) {
  return ShareOf(problem, report, report.inliers);
}

std::optional<double> UnexplainedShareOfAll(const CalibrationProblem& problem,
                                            const SolveReport& report) {
  std::vector<int> all(std::max(problem.pairs_3d3d.size(), problem.pairs_2d3d.size()));
  std::iota(all.begin(), all.end(), 0);
  return ShareOf(problem, report, all);
}

std::optional<double> LogChanceOfUsed(const CalibrationProblem& problem,
                                      const SolveReport& report) {
  if (!IsOfOneKind(problem)) return std::nullopt;
  const std::vector<double>& residuals = ResidualsOf(problem, report);
  const std::size_t count = residuals.size();
  const std::size_t used = report.inliers.size();
  constexpr std::size_t kAbsorbed = 3;
  if (used < kAbsorbed || used >= count) return std::nullopt;
  double largest = 0.0;
  for (const int i : report.inliers) {
    largest = std::max(largest, residuals[static_cast<std::size_t>(i)]);
  }
  const double share = problem.pairs_2d3d.empty() ? ShareWithin(PointsOf(problem), largest)
                                                  : ShareWithin(PixelsOf(problem), largest);
  return std::log(static_cast<double>(count - kAbsorbed)) +
         LogChoose(static_cast<int>(count), static_cast<int>(used)) +
         LogChoose(static_cast<int>(used), static_cast<int>(kAbsorbed)) +
         static_cast<double>(used - kAbsorbed) * std::log(std::min(1.0, share));
}

std::optional<double> DistanceRatio(const CalibrationProblem& problem, const SolveReport& report) {
  if (problem.pairs_2d3d.empty() || !problem.pairs_3d3d.empty()) return std::nullopt;
  double from_camera = 0.0;
  double from_lidar = 0.0;
  for (const int i : report.inliers) {
    const Eigen::Vector3d& point = problem.pairs_2d3d[static_cast<std::size_t>(i)].point_in_lidar;
    from_lidar += point.squaredNorm();
    from_camera += (report.cam_from_lidar * point).squaredNorm();
  }
  if (!(from_lidar > 0.0)) return std::nullopt;
  return std::sqrt(from_camera / from_lidar);
}

std::optional<std::string> DescribeDistance(const CalibrationProblem& problem,
                                            const SolveReport& report) {
  constexpr double kPoor = 0.1;
  const std::optional<double> ratio = DistanceRatio(problem, report);
  const std::optional<double> share = UnexplainedShare(problem, report);
  if (!ratio || !share || *ratio < kMaxDistanceRatio || *share < kPoor) return std::nullopt;
  return fmt::format(
      "distance: the answer has the points {:.1f} times as far from the camera as from the LiDAR "
      "and the sensors {:.3g} m apart, and its residuals are {:.0f} percent of the spread of the "
      "pixels (of 11 deg at most), as where pixels or points are in another unit (degrees, "
      "angles and a range instead of x, y and z); check both",
      *ratio, report.cam_from_lidar.translation.norm(), 100.0 * *share);
}

std::optional<std::string> WhyUnusable(const CalibrationProblem& problem,
                                       const SolveReport& report) {
  const std::optional<double> share = UnexplainedShare(problem, report);
  if (share && *share > kMaxUnexplainedShare) {
    return fmt::format(
        "no pose explains these pairs: what it leaves is {:.0f} percent of their spread, or of 11 "
        "deg where pixels spread more (at most {:.0f} in measurements that belong together). Check "
        "which point belongs to which",
        100.0 * *share, 100.0 * kMaxUnexplainedShare);
  }
  const std::optional<double> log_chance = LogChanceOfUsed(problem, report);
  if (log_chance && *log_chance >= 0.0) {
    const std::optional<double> of_all = UnexplainedShareOfAll(problem, report);
    if (of_all && *of_all > kMaxUnexplainedShare) {
      return fmt::format(
          "the answer is based on {} of {} pairs, which fit a pose whatever they are, and the "
          "others contradict it. Check which point belongs to which, or measure more pairs",
          report.inliers.size(), ResidualsOf(problem, report).size());
    }
  }
  const std::optional<double> ratio = DistanceRatio(problem, report);
  if (share && *share >= kUsualUnexplainedShare && ratio && *ratio > kMaxDistanceRatio) {
    return fmt::format(
        "the answer has the points {:.1f} times as far from the camera as from the LiDAR, and "
        "still leaves {:.0f} percent of the spread of the pixels. Check the units of pixels and "
        "points, and which belongs to which",
        *ratio, 100.0 * *share);
  }
  return std::nullopt;
}

bool IsSupported(const CalibrationProblem& problem, const SolveReport& report) {
  constexpr double kFarBeyondChance = -18.42068074395237;  // log 1e-8
  if (!IsOfOneKind(problem) || report.inliers.empty()) return false;
  if (2 * report.inliers.size() >= ResidualsOf(problem, report).size()) return true;
  const std::optional<double> log_chance = LogChanceOfUsed(problem, report);
  return log_chance && *log_chance < kFarBeyondChance;
}

std::optional<std::string> DescribeSelection(const CalibrationProblem& problem,
                                             const SolveReport& report) {
  constexpr double kNoticeable = 1.6;
  constexpr double kUnknowns = 6.0;
  const bool in_pixels = !problem.pairs_2d3d.empty();
  if (!IsOfOneKind(problem) || !report.noise || report.noise->is_given) return std::nullopt;
  const std::vector<double>& residuals = ResidualsOf(problem, report);
  const std::vector<int> outlying = OutlyingPairs(report, in_pixels);
  double of_used = 0.0;
  double of_all = 0.0;
  std::size_t left_out = 0;
  for (int i = 0; i < static_cast<int>(residuals.size()); ++i) {
    const double squared =
        residuals[static_cast<std::size_t>(i)] * residuals[static_cast<std::size_t>(i)];
    if (std::binary_search(report.inliers.begin(), report.inliers.end(), i)) {
      of_used += squared;
    } else if (std::isfinite(squared) &&
               std::find(outlying.begin(), outlying.end(), i) == outlying.end()) {
      ++left_out;
      of_all += squared;
    }
  }
  of_all += of_used;
  const double dimension = in_pixels ? 2.0 : 3.0;
  const double freedom = dimension * static_cast<double>(report.inliers.size()) - kUnknowns;
  if (left_out == 0 || !(freedom > 0.0) || !(of_used > 0.0)) return std::nullopt;
  const double freedom_of_all = freedom + dimension * static_cast<double>(left_out);
  const double factor = std::sqrt(of_all / freedom_of_all / (of_used / freedom));
  if (!(factor > kNoticeable)) return std::nullopt;
  return fmt::format(
      "selection: {} of the {} pairs that the answer leaves out need be no outliers: chosen as "
      "those that fit best, its {} pairs show too small a noise. If these are true, the noise is "
      "{:.1f} times as large, and the sigmas are at least that much too small; more pairs show "
      "which",
      left_out, residuals.size() - report.inliers.size(), report.inliers.size(), factor);
}

std::optional<std::string> DescribeMisfit(const CalibrationProblem& problem,
                                          const SolveReport& report) {
  const bool is_stated = std::any_of(problem.pairs_3d3d.begin(), problem.pairs_3d3d.end(),
                                     [](const Pair3d3d& pair) { return HasKnownNoise(pair); }) ||
                         std::any_of(problem.pairs_2d3d.begin(), problem.pairs_2d3d.end(),
                                     [](const Pair2d3d& pair) { return HasKnownNoise(pair); });
  const std::optional<double> share = UnexplainedShare(problem, report);
  if (is_stated || !share || *share < kUsualUnexplainedShare) return std::nullopt;
  return fmt::format(
      "misfit: the residuals are {:.0f} percent of the spread of the measurements (of 11 deg at "
      "most), where {:.0f} or less is usual, so that the stated uncertainty, which takes them for "
      "noise, may be wrong; "
      "check which point belongs to which, and that no sensor or board moved",
      100.0 * *share, 100.0 * kUsualUnexplainedShare);
}

}  // namespace sextant
