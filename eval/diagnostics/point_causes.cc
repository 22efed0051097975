// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "eval/diagnostics/causes.h"
#include "eval/diagnostics/complete_boards.h"
#include "solvers/kernels/kabsch.h"

namespace sextant {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Eigen::Vector3d CentreOfPoints(const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

// Root mean square distance from the centre.
double SpreadOfPoints(const Points& points) {
  const Eigen::Vector3d centre = CentreOfPoints(points);
  double squares = 0.0;
  for (const Eigen::Vector3d& point : points) squares += (point - centre).squaredNorm();
  return std::sqrt(squares / static_cast<double>(points.size()));
}

// A unit of length that is not the metre.
struct Unit {
  double in_m;
  const char* name;
};
constexpr std::array<Unit, 6> kUnits = {{{0.001, "millimetres"},
                                         {0.01, "centimetres"},
                                         {0.1, "decimetres"},
                                         {0.3048, "feet"},
                                         {0.0254, "inches"},
                                         {0.9144, "yards"}}};

// What makes the lengths of one sensor `factor` > 1 times those of the other.
std::string CauseOfFactor(double factor, const char* longer) {
  constexpr double kTolerance = 0.02;
  for (const Unit& unit : kUnits) {
    if (std::abs(factor * unit.in_m - 1.0) > kTolerance) continue;
    return fmt::format("as if they were in {}; multiply the {}'s points by {:.4g}", unit.name,
                       longer, unit.in_m);
  }
  return "which no unit explains; check the size of the board that each sensor assumes, the "
         "camera's focal length and the LiDAR's range scale";
}

/// One sensor's lengths as a multiple of the other's, with the F-test of that factor.
struct ScaleTest {
  double ratio = 1.0;  // LiDAR's lengths over the camera's.
  double f = 0.0;
  double rmse_as_given = 0.0;
  double rmse_without = 0.0;  // In the camera's unit.
};

std::optional<ScaleTest> TestScale(const Points& in_cam, const Points& in_lidar) {
  const double ratio = SpreadOfPoints(in_lidar) / SpreadOfPoints(in_cam);
  if (!std::isfinite(ratio)) return std::nullopt;
  Points scaled = in_lidar;
  for (Eigen::Vector3d& point : scaled) point /= ratio;
  const Expected<KabschFit> given = FitKabsch(in_cam, in_lidar);
  const Expected<KabschFit> with_ratio = FitKabsch(in_cam, scaled);
  if (!given || !with_ratio) return std::nullopt;
  const auto n = static_cast<double>(in_cam.size());
  return ScaleTest{.ratio = ratio,
                   .f = (given->sum_squares - with_ratio->sum_squares) * (3.0 * n - 7.0) /
                        std::max(with_ratio->sum_squares, 1e-300),
                   .rmse_as_given = std::sqrt(given->sum_squares / n),
                   .rmse_without = std::sqrt(with_ratio->sum_squares / n)};
}

std::optional<std::string> FindScale(const Points& in_cam, const Points& in_lidar) {
  constexpr double kMinDeviation = 0.003;
  constexpr double kMaxOfRmse = 0.5;
  constexpr double kMinF = 100.0;
  const std::optional<ScaleTest> test = TestScale(in_cam, in_lidar);
  if (!test || std::abs(test->ratio - 1.0) < kMinDeviation || test->f < kMinF ||
      test->rmse_without > kMaxOfRmse * test->rmse_as_given) {
    return std::nullopt;
  }
  const bool lidar_is_longer = test->ratio > 1.0;
  const double factor = lidar_is_longer ? test->ratio : 1.0 / test->ratio;
  const char* longer = lidar_is_longer ? "LiDAR" : "camera";
  const double to_m = lidar_is_longer ? 1.0 : test->ratio;
  return fmt::format(
      "units: the {}'s lengths are {:.4g} times the {}'s, {} (RMSE {:.4g} m as given, {:.4g} m "
      "without this factor)",
      longer, factor, lidar_is_longer ? "camera" : "LiDAR", CauseOfFactor(factor, longer),
      test->rmse_as_given, to_m * test->rmse_without);
}

/// Both sensors' lengths as a multiple of the boards' known ones, the same for every edge: a single
/// edge that differs is no matter of units.
std::optional<std::string> FindBoardScale(const CalibrationProblem& problem) {
  constexpr double kMinDeviation = 0.05;
  constexpr double kMaxRatio = 1.1;  ///< Between the factors of two edges.
  double smallest = std::numeric_limits<double>::infinity();
  double largest = 0.0;
  double in_cam = 0.0;
  double in_lidar = 0.0;
  double known = 0.0;
  for (const BoardPairs& group : CompleteBoards(problem.pairs_3d3d)) {
    const int id = problem.pairs_3d3d[group.pair(0)].id.board;
    const auto board = std::ranges::find(problem.boards, id, &Board::id);
    if (board == problem.boards.end()) continue;
    const auto edges = board->EdgeLengths();
    for (int i = 0; i < kCornersPerBoard; ++i) {
      const Pair3d3d& from = problem.pairs_3d3d[group.pair(i)];
      const Pair3d3d& to = problem.pairs_3d3d[group.pair((i + 1) % kCornersPerBoard)];
      const double edge_m = edges[static_cast<std::size_t>(i)];
      known += edge_m;
      const double factor = (to.point_in_cam - from.point_in_cam).norm() / edge_m;
      smallest = std::min(smallest, factor);
      largest = std::max(largest, factor);
      in_cam += (to.point_in_cam - from.point_in_cam).norm();
      in_lidar += (to.point_in_lidar - from.point_in_lidar).norm();
    }
  }
  if (!(known > 0.0) || largest > kMaxRatio * smallest) return std::nullopt;
  const double of_cam = in_cam / known;
  const double of_lidar = in_lidar / known;
  const bool both_differ =
      std::min(std::abs(of_cam - 1.0), std::abs(of_lidar - 1.0)) > kMinDeviation;
  if (!both_differ || std::abs(of_cam / of_lidar - 1.0) > kMinDeviation) return std::nullopt;
  return fmt::format(
      "units: the boards' edges are {:.4g} times their known lengths in both sensors; check the "
      "boards' sizes and that everything is in metres",
      0.5 * (of_cam + of_lidar));
}

std::optional<std::string> FindFarCamera(const Points& in_cam) {
  constexpr double kFar_m = 1e3;
  constexpr double kOfSpread = 1e3;
  const double distance = CentreOfPoints(in_cam).norm();
  if (distance < kFar_m || distance < kOfSpread * SpreadOfPoints(in_cam)) return std::nullopt;
  return fmt::format(
      "frame: the camera's points are {:.3g} m from the camera, as if they were in a frame of the "
      "world; the answer then relates the LiDAR to that frame, and not to the camera",
      distance);
}

/// Camera points behind the camera: most, or more than LiDAR points would be, as when the sensors
/// are exchanged.
std::optional<std::string> FindExchangedSensors(const CalibrationProblem& problem) {
  constexpr std::size_t kMaxListed = 5;
  const bool is_wide = problem.camera && problem.camera->model != CameraModel::kPinhole &&
                       problem.camera->model != CameraModel::kBrownConrady;
  if (is_wide) return std::nullopt;
  std::vector<std::size_t> behind;
  std::size_t lidar_behind = 0;
  for (std::size_t i = 0; i < problem.pairs_3d3d.size(); ++i) {
    const Pair3d3d& pair = problem.pairs_3d3d[i];
    if (pair.point_in_cam.z() <= 0.0) behind.push_back(i + 1);
    lidar_behind += pair.point_in_lidar.z() <= 0.0 ? 1U : 0U;
  }
  const bool exchanged = behind.size() > lidar_behind;
  if (!exchanged && 2 * behind.size() <= problem.pairs_3d3d.size()) return std::nullopt;
  const std::size_t listed = std::min(behind.size(), kMaxListed);
  return fmt::format(
      "roles: the camera points of {} of {} pairs (pair {}{}) are behind the camera (z <= 0){}",
      behind.size(), problem.pairs_3d3d.size(),
      fmt::join(behind.begin(), behind.begin() + static_cast<std::ptrdiff_t>(listed), ", "),
      behind.size() > listed ? ", ..." : "",
      exchanged ? fmt::format(", and {} of the LiDAR's would be: the sensors seem to be exchanged; "
                              "exchange their columns, or read the answer as lidar_from_cam",
                              lidar_behind)
                : "; the camera frame is x right, y down, z forward");
}

// Whether the boards' own sizes speak against a ratio between the lengths of all pairs, as where a
// board moved: by four sigmas of the noise that boards under poses of their own leave.
bool BoardsContradictRatio(const CalibrationProblem& problem, double ratio) {
  constexpr double kSigmas = 4.0;
  double in_cam_squares = 0.0;
  double in_lidar_squares = 0.0;
  double residual_squares = 0.0;
  double freedom = 0.0;
  for (const BoardPairs& group : CompleteBoards(problem.pairs_3d3d)) {
    Points in_cam;
    Points in_lidar;
    for (int i = 0; i < kCornersPerBoard; ++i) {
      in_cam.push_back(problem.pairs_3d3d[group.pair(i)].point_in_cam);
      in_lidar.push_back(problem.pairs_3d3d[group.pair(i)].point_in_lidar);
    }
    const double of_lidar = SpreadOfPoints(in_lidar);
    const double of_cam = SpreadOfPoints(in_cam);
    Points scaled = in_lidar;
    for (Eigen::Vector3d& point : scaled) point *= of_cam / of_lidar;
    const Expected<KabschFit> fit = FitKabsch(in_cam, scaled);
    if (!fit) continue;
    in_cam_squares += kCornersPerBoard * of_cam * of_cam;
    in_lidar_squares += kCornersPerBoard * of_lidar * of_lidar;
    residual_squares += fit->sum_squares;
    freedom += 3.0 * kCornersPerBoard - 7.0;
  }
  if (freedom < 1.0) return false;
  const double of_boards = std::sqrt(in_lidar_squares / in_cam_squares);
  const double sigma = std::sqrt(residual_squares / freedom / in_cam_squares);
  return std::abs(of_boards - ratio) > kSigmas * sigma &&
         std::abs(of_boards - ratio) > 0.5 * std::abs(ratio - 1.0);
}

}  // namespace

std::optional<std::string> SlightScale(const CalibrationProblem& problem) {
  constexpr std::size_t kMinPairs = 8;
  constexpr double kMinDeviation = 0.003;
  constexpr double kMinF = 30.0;
  constexpr double kMinHalfF = 8.0;
  constexpr double kMaxApart = 0.5;  // The halves' deviations relative to that of all.
  if (problem.pairs_3d3d.size() < kMinPairs) return std::nullopt;
  Points in_cam;
  Points in_lidar;
  std::array<Points, 2> half_in_cam;
  std::array<Points, 2> half_in_lidar;
  for (std::size_t i = 0; i < problem.pairs_3d3d.size(); ++i) {
    const Pair3d3d& pair = problem.pairs_3d3d[i];
    in_cam.push_back(pair.point_in_cam);
    in_lidar.push_back(pair.point_in_lidar);
    half_in_cam[i % 2].push_back(pair.point_in_cam);
    half_in_lidar[i % 2].push_back(pair.point_in_lidar);
  }
  const std::optional<ScaleTest> all = TestScale(in_cam, in_lidar);
  const std::optional<ScaleTest> even = TestScale(half_in_cam[0], half_in_lidar[0]);
  const std::optional<ScaleTest> odd = TestScale(half_in_cam[1], half_in_lidar[1]);
  if (!all || !even || !odd || std::abs(all->ratio - 1.0) < kMinDeviation) return std::nullopt;
  const double apart = std::abs(even->ratio - odd->ratio) / std::abs(all->ratio - 1.0);
  if (all->f < kMinF || std::min(even->f, odd->f) < kMinHalfF || apart > kMaxApart) {
    return std::nullopt;
  }
  if (BoardsContradictRatio(problem, all->ratio)) return std::nullopt;
  const bool lidar_is_longer = all->ratio > 1.0;
  return fmt::format(
      "scale: the {}'s lengths are {:.4g} times the {}'s (RMSE {:.3g} m as given, {:.3g} m without "
      "this factor), in every second pair as in the others; the translation may be off by this "
      "share of the distance. Check the size of the board that each sensor assumes, the camera's "
      "focal length and the LiDAR's ranges",
      lidar_is_longer ? "LiDAR" : "camera", lidar_is_longer ? all->ratio : 1.0 / all->ratio,
      lidar_is_longer ? "camera" : "LiDAR", all->rmse_as_given, all->rmse_without);
}

std::optional<Reflection> FindReflection(const std::vector<Eigen::Vector3d>& in_cam,
                                         const std::vector<Eigen::Vector3d>& in_lidar) {
  constexpr double kRatio = 2.0;
  const auto rmse = [&](double sum_squares) {
    return std::sqrt(sum_squares / static_cast<double>(in_cam.size()));
  };
  const Expected<KabschFit> fit = FitKabsch(in_cam, in_lidar);
  if (fit) {
    const bool fits_better = fit->sum_squares > kRatio * kRatio * fit->mirrored_sum_squares &&
                             fit->sum_squares > 1e-12 * in_cam.front().squaredNorm();
    if (!fits_better) return std::nullopt;
    return Reflection{.rmse_m = rmse(fit->mirrored_sum_squares), .is_certain = false};
  }
  if (fit.error().code != ErrorCode::kMirrored) return std::nullopt;
  // A rotation of the points through the origin is a reflection of them.
  Points negated = in_lidar;
  for (Eigen::Vector3d& point : negated) point = -point;
  const Expected<KabschFit> reflected = FitKabsch(in_cam, negated);
  if (!reflected) return std::nullopt;
  return Reflection{.rmse_m = rmse(reflected->sum_squares), .is_certain = true};
}

std::vector<std::string> CausesInPoints(const CalibrationProblem& problem) {
  constexpr double kMaxSpread_m = 200.0;
  std::vector<std::string> causes;
  if (problem.pairs_3d3d.size() < 3) return causes;
  Points in_cam;
  Points in_lidar;
  for (const Pair3d3d& pair : problem.pairs_3d3d) {
    in_cam.push_back(pair.point_in_cam);
    in_lidar.push_back(pair.point_in_lidar);
  }
  const auto add = [&causes](std::optional<std::string> cause) {
    if (cause) causes.push_back(*std::move(cause));
    return cause.has_value();
  };
  if (!add(FindScale(in_cam, in_lidar)) && !add(FindBoardScale(problem))) {
    const double spread = std::min(SpreadOfPoints(in_cam), SpreadOfPoints(in_lidar));
    if (spread > kMaxSpread_m) {
      causes.push_back(fmt::format(
          "units: the points of both sensors spread over {:.4g} m, which is far for a board; if "
          "they are in millimetres, multiply all of them by 0.001",
          spread));
    }
  }
  const std::optional<Reflection> reflection = FindReflection(in_cam, in_lidar);
  if (reflection && reflection->is_certain) {
    causes.emplace_back(
        "mirrored: the LiDAR's points are a mirror image of the camera's: an axis has the wrong "
        "sign, two are exchanged, or the points are in a wrong order; the LiDAR frame is x "
        "forward, y left, z up, the camera's x right, y down, z forward");
  }
  add(FindExchangedSensors(problem));
  add(FindFarCamera(in_cam));
  return causes;
}

}  // namespace sextant
