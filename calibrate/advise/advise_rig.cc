// SPDX-License-Identifier: Apache-2.0
#include "calibrate/advise/advise_rig.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/units.h"
#include "calibrate/advise/advise.h"
#include "geometry/symmetric.h"
#include "solvers/blocks/scaled_inverse.h"
#include "solvers/rig/rig_board_information.h"

namespace sextant {
namespace {

constexpr double kSeenWithin_deg = 15.0;
constexpr double kSteepestTilt_deg = 60.0;
constexpr double kFarther = 1.3;

/// How one sensor has seen boards so far.
struct SensorSight {
  std::vector<Eigen::Vector3d> directions;
  double farthest_m = 0.0;
  Matrix6d in_board = Matrix6d::Zero();  ///< Mean of BoardInformation::in_board.

  bool Sees(const Rigid3d& sensor_from_board) const {
    const double distance = sensor_from_board.translation.norm();
    if (!(distance > 0.0) || distance > kFarther * farthest_m) return false;
    const Eigen::Vector3d direction = sensor_from_board.translation / distance;
    const Eigen::Vector3d normal = sensor_from_board.rotation * Eigen::Vector3d::UnitZ();
    if (direction.dot(normal) < std::cos(kRadPerDeg * kSteepestTilt_deg)) return false;
    const double least = std::cos(kRadPerDeg * kSeenWithin_deg);
    return std::ranges::any_of(
        directions, [&](const Eigen::Vector3d& seen) { return seen.dot(direction) > least; });
  }
};

std::vector<SensorSight> SightsOf(const RigProblem& problem,
                                  const std::vector<BoardInformation>& all) {
  std::vector<SensorSight> sights(problem.sensors.size());
  for (const BoardInformation& seen : all) {
    SensorSight& sight = sights[seen.sensor];
    const double distance = seen.sensor_from_board.translation.norm();
    sight.directions.push_back(seen.sensor_from_board.translation / std::max(distance, 1e-9));
    sight.farthest_m = std::max(sight.farthest_m, distance);
    sight.in_board += seen.in_board;
  }
  for (SensorSight& sight : sights) {
    sight.in_board /= static_cast<double>(std::max<std::size_t>(sight.directions.size(), 1));
  }
  return sights;
}

// What a board adds to the poses of all sensors but the root, with the board's own pose unknown.
class BoardGain {
 public:
  BoardGain(const RigEstimate& estimate, const std::vector<SensorSight>& sights)
      : estimate_(estimate), sights_(sights) {}

  /// None where fewer than two sensors see it.
  std::optional<Eigen::MatrixXd> At(const Rigid3d& root_from_board) const {
    const Eigen::Index poses = estimate_.covariance.rows();
    Eigen::MatrixXd shared = Eigen::MatrixXd::Zero(poses, poses);
    Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(6, poses);
    Matrix6d own = Matrix6d::Zero();
    Eigen::Index column = 0;
    int seen_by = 0;
    for (std::size_t s = 0; s < sights_.size(); ++s) {
      const Eigen::Index at = s == estimate_.root ? -1 : std::exchange(column, column + 6);
      const Rigid3d& sensor_from_root = *estimate_.sensor_from_root[s];
      const Rigid3d pose = sensor_from_root * root_from_board;
      if (!sights_[s].Sees(pose)) continue;
      ++seen_by;
      const Matrix6d information = InSensor(sights_[s].in_board, pose);
      const ProductJacobians by = JacobiansOfProduct(sensor_from_root, root_from_board);
      own += by.by_right.transpose() * information * by.by_right;
      if (at < 0) continue;
      shared.block<6, 6>(at, at) += by.by_left.transpose() * information * by.by_left;
      mixed.middleCols<6>(at) += by.by_right.transpose() * information * by.by_left;
    }
    if (seen_by < 2) return std::nullopt;
    return Eigen::MatrixXd(shared - mixed.transpose() * ScaledInverse(own) * mixed);
  }

  std::vector<std::size_t> SeenBy(const Rigid3d& root_from_board) const {
    std::vector<std::size_t> sensors;
    for (std::size_t s = 0; s < sights_.size(); ++s) {
      if (sights_[s].Sees(*estimate_.sensor_from_root[s] * root_from_board)) sensors.push_back(s);
    }
    return sensors;
  }

 private:
  static Matrix6d InSensor(const Matrix6d& in_board, const Rigid3d& pose) {
    Matrix6d turn = Matrix6d::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = pose.rotation.toRotationMatrix();
    return turn * in_board * turn.transpose();
  }

  const RigEstimate& estimate_;
  const std::vector<SensorSight>& sights_;
};

double UsualDistance(const std::vector<BoardInformation>& seen) {
  double sum = 0.0;
  for (const BoardInformation& one : seen) sum += one.sensor_from_board.translation.norm();
  return seen.empty() ? 1.0 : sum / static_cast<double>(seen.size());
}

// The variance of a point at that distance, along the least certain direction.
double WorstVariance(const Matrix6d& covariance, double distance_m) {
  const auto largest = [](const Eigen::Matrix3d& part) { return EigenOf<3>(part).values[2]; };
  return largest(covariance.bottomRightCorner<3, 3>()) +
         distance_m * distance_m * largest(covariance.topLeftCorner<3, 3>());
}

struct SensorIndices {
  std::size_t a = 0;
  std::size_t b = 1;
};

SensorIndices WeakestPairOf(const RigEstimate& estimate, double distance_m) {
  SensorIndices weakest;
  double largest = -1.0;
  for (std::size_t a = 0; a < estimate.sensor_from_root.size(); ++a) {
    for (std::size_t b = a + 1; b < estimate.sensor_from_root.size(); ++b) {
      const double variance = WorstVariance(estimate.Between(a, b).covariance, distance_m);
      if (variance > largest) {
        largest = variance;
        weakest = {a, b};
      }
    }
  }
  return weakest;
}

// Boards as they were held so far and halfway between two of them, nearer and farther, turned and
// tilted.
std::vector<Rigid3d> GridAbout(const std::vector<BoardInformation>& seen,
                               const RigEstimate& estimate) {
  constexpr std::size_t kMaxPlaces = 25;
  std::map<std::size_t, Rigid3d> placed;
  for (const BoardInformation& one : seen) {
    placed.emplace(one.placement,
                   estimate.sensor_from_root[one.sensor]->Inverse() * one.sensor_from_board);
  }
  std::vector<Rigid3d> places;
  const std::size_t step = 1 + placed.size() / kMaxPlaces;
  std::size_t index = 0;
  for (const auto& [placement, pose] : placed) {
    if (index++ % step == 0) places.push_back(pose);
  }
  std::vector<Rigid3d> grid;
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = i; j < places.size(); ++j) {
      const Eigen::Vector3d middle = 0.5 * (places[i].translation + places[j].translation);
      for (const double turn_deg : {-40.0, -20.0, 0.0, 20.0, 40.0}) {
        for (const double lean_deg : {-40.0, 0.0, 40.0}) {
          grid.push_back({places[i].rotation *
                              Eigen::AngleAxisd(kRadPerDeg * turn_deg, Eigen::Vector3d::UnitY()) *
                              Eigen::AngleAxisd(kRadPerDeg * lean_deg, Eigen::Vector3d::UnitX()),
                          middle});
        }
      }
    }
  }
  return grid;
}

// The camera-like axes of a sensor without intrinsics, whose x is forward, y left and z up.
Rigid3d AsSeenBy(const RigProblem& problem, std::size_t sensor, const Rigid3d& sensor_from_board) {
  if (problem.sensors[sensor].camera) return sensor_from_board;
  Eigen::Matrix3d axes;
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return Rigid3d{Eigen::Quaterniond(axes), Eigen::Vector3d::Zero()} * sensor_from_board;
}

/// One more board at each place of the grid.
class RigAdviser {
 public:
  RigAdviser(const RigProblem& problem, const RigEstimate& estimate)
      : problem_(problem),
        estimate_(estimate),
        seen_(BoardInformationOf(problem, estimate)),
        sights_(SightsOf(problem, seen_)),
        gain_(estimate, sights_),
        information_(ScaledInverse(estimate.covariance)) {}

  Expected<RigAdvice> Run() const {
    RigAdvice advice;
    advice.distance_m = UsualDistance(seen_);
    const SensorIndices pair = WeakestPairOf(estimate_, advice.distance_m);
    advice.weakest = {problem_.sensors[pair.a].name, problem_.sensors[pair.b].name,
                      estimate_.Between(pair.a, pair.b), CommonViews(pair)};
    const std::vector<Rigid3d> grid = GridAbout(seen_, estimate_);
    std::vector<double> volumes(grid.size(), std::numeric_limits<double>::infinity());
    tbb::parallel_for(std::size_t{0}, grid.size(), [&](std::size_t i) {
      const auto covariance = CovarianceWith(grid[i], pair);
      if (covariance) volumes[i] = EigenOf<6>(*covariance).values.array().log().sum();
    });
    const auto best = std::ranges::min_element(volumes);
    if (best == volumes.end() || !std::isfinite(*best)) {
      return MakeError(ErrorCode::kDegenerate,
                       "no place is known at which two sensors would see a board: record boards "
                       "where their views overlap");
    }
    advice.considered = static_cast<int>(
        std::ranges::count_if(volumes, [](double volume) { return std::isfinite(volume); }));
    advice.root_from_board = grid[static_cast<std::size_t>(best - volumes.begin())];
    advice.covariance = *CovarianceWith(advice.root_from_board, pair);
    Describe(advice);
    return advice;
  }

 private:
  int CommonViews(const SensorIndices& pair) const {
    const std::array<std::size_t, 2> sensors = {pair.a, pair.b};
    return static_cast<int>(Restricted(problem_, sensors).placements.size());
  }

  std::optional<Matrix6d> CovarianceWith(const Rigid3d& root_from_board,
                                         const SensorIndices& pair) const {
    const auto added = gain_.At(root_from_board);
    if (!added) return std::nullopt;
    RigEstimate with{.root = estimate_.root, .sensor_from_root = estimate_.sensor_from_root};
    with.covariance = ScaledInverse(information_ + *added);
    return with.Between(pair.a, pair.b).covariance;
  }

  void Describe(RigAdvice& advice) const {
    const std::vector<std::size_t> sensors = gain_.SeenBy(advice.root_from_board);
    for (const std::size_t sensor : sensors) {
      advice.seen_by.push_back(problem_.sensors[sensor].name);
    }
    // Cameras show people best where a board is.
    std::size_t observer = sensors.front();
    for (const std::size_t sensor : sensors) {
      if (problem_.sensors[sensor].camera && !problem_.sensors[observer].camera) observer = sensor;
    }
    const Rigid3d pose = *estimate_.sensor_from_root[observer] * advice.root_from_board;
    advice.sentence =
        DescribePlacement(problem_.boards[0], AsSeenBy(problem_, observer, pose),
                          {.name = problem_.sensors[observer].name, .corner_up = false});
  }

  const RigProblem& problem_;
  const RigEstimate& estimate_;
  std::vector<BoardInformation> seen_;
  std::vector<SensorSight> sights_;
  BoardGain gain_;
  Eigen::MatrixXd information_;
};

}  // namespace

Expected<RigAdvice> AdviseRig(const RigFile& rig) {
  SEXTANT_ASSIGN_OR_RETURN(const RigEstimate estimate, SolveRig(rig.problem, {.root = rig.root}));
  if (!estimate.unconnected.empty()) {
    return MakeError(ErrorCode::kMissingData, estimate.unconnected.front());
  }
  SEXTANT_ASSIGN_OR_RETURN(RigAdvice advice, RigAdviser(rig.problem, estimate).Run());
  advice.warnings = estimate.warnings;
  advice.warnings.insert(advice.warnings.end(), estimate.refutations.begin(),
                         estimate.refutations.end());
  return advice;
}

}  // namespace sextant
