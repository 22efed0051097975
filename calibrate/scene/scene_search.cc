// SPDX-License-Identifier: Apache-2.0
#include "calibrate/scene/scene_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/units.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr double kTypicalDepth_m = 8.0;  // Turns a rotation into a translation of like effect.
constexpr double kGridStep_rad = 0.5 * kRadPerDeg;
constexpr int kGridHalf = 4;
constexpr int kGridLevel = 2;
constexpr std::size_t kStarts = 12;
constexpr int kComparing = 1;  // The level at which optima are compared.
constexpr double kFloorRotation_rad = 0.05 * kRadPerDeg;
constexpr double kFloorTranslation_m = 0.012;

// The scenes with a weak prior around the start: it holds directions that they leave open.
struct Objective {
  std::span<const ScenePair> pairs;
  Rigid3d start;
  std::size_t stride = 1;  // Of the edges, at the coarse levels.

  SceneScore At(int level, const Rigid3d& pose) const {
    constexpr double kWeight = 0.15;
    constexpr double kRotation_rad = 2.0 * kRadPerDeg;
    constexpr double kTranslation_m = 0.1;
    SceneScore score = ScoreScenes(pairs, level, pose, level > 0 ? stride : 1);
    Vector6d precision;
    precision << Eigen::Vector3d::Constant(kWeight / (kRotation_rad * kRotation_rad)),
        Eigen::Vector3d::Constant(kWeight / (kTranslation_m * kTranslation_m));
    const Vector6d moved = PoseDifference(pose, start);
    score.value -= 0.5 * moved.dot(precision.cwiseProduct(moved));
    score.gradient -= precision.cwiseProduct(moved);
    return score;
  }
  const ScenePair& front() const { return pairs[0]; }
};

struct Climbed {
  Rigid3d pose;
  double score = 0.0;
};

// A step of one blur of the level at typical depth, per axis.
Vector6d ScaleOf(const Objective& scenes, int level) {
  const double angle = scenes.front().fields.Sigma_px(level) / scenes.front().camera.fx_px;
  Vector6d scale;
  scale << angle, angle, angle, kTypicalDepth_m * Eigen::Vector3d::Constant(angle);
  return scale;
}

// Minus the second derivative of the score in steps of `scale`, by central differences of
// gradients.
Matrix6d CurvatureOf(const Objective& scenes, int level, const Rigid3d& pose,
                     const Vector6d& scale) {
  constexpr double kStep = 0.7;
  Matrix6d curvature;
  for (int i = 0; i < 6; ++i) {
    const Vector6d delta = kStep * scale(i) * Vector6d::Unit(i);
    const Vector6d ahead = scenes.At(level, Perturb(pose, delta)).gradient;
    const Vector6d back = scenes.At(level, Perturb(pose, -delta)).gradient;
    curvature.col(i) = (back - ahead).cwiseProduct(scale) / (2.0 * kStep);
  }
  return 0.5 * (curvature + curvature.transpose());
}

// The inverse with eigenvalues of at least `least` times the largest.
Matrix6d BoundedInverse(const Matrix6d& curvature, double least) {
  const SymmetricEigen<6> eigen = EigenOf<6>(curvature);
  const double top = std::max(eigen.values.cwiseAbs().maxCoeff(), 1e-12);
  const Vector6d inverse = eigen.values.cwiseMax(least * top).cwiseInverse();
  return eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose();
}

// Newton's method with bounded steps; a step must raise the score.
Rigid3d ClimbLevel(const Objective& scenes, int level, Rigid3d pose) {
  constexpr int kMaxSteps = 6;
  constexpr double kMaxStep = 1.5;
  constexpr double kDone = 0.02;
  const Vector6d scale = ScaleOf(scenes, level);
  SceneScore here = scenes.At(level, pose);
  for (int i = 0; i < kMaxSteps; ++i) {
    const Matrix6d inverse = BoundedInverse(CurvatureOf(scenes, level, pose, scale), 0.02);
    Vector6d step = inverse * here.gradient.cwiseProduct(scale);
    if (step.norm() > kMaxStep) step *= kMaxStep / step.norm();
    bool raised = false;
    for (int halvings = 0; halvings < 4 && !raised; ++halvings) {
      const Rigid3d next = Perturb(pose, step.cwiseProduct(scale));
      const SceneScore there = scenes.At(level, next);
      raised = there.value > here.value;
      if (raised) {
        pose = next;
        here = there;
      } else {
        step *= 0.5;
      }
    }
    if (!raised || step.norm() < kDone) break;
  }
  return pose;
}

Climbed Climb(const Objective& scenes, Rigid3d pose, int from_level, int to_level) {
  for (int level = from_level; level >= to_level; --level) pose = ClimbLevel(scenes, level, pose);
  return {pose, scenes.At(kComparing, pose).value};
}

// The best cells of a grid of rotations, none a neighbour of another.
std::vector<Rigid3d> GridStarts(const Objective& scenes) {
  std::vector<Climbed> cells;
  for (int x = -kGridHalf; x <= kGridHalf; ++x) {
    for (int y = -kGridHalf; y <= kGridHalf; ++y) {
      for (int z = -kGridHalf; z <= kGridHalf; ++z) {
        Vector6d delta = Vector6d::Zero();
        delta.head<3>() = kGridStep_rad * Eigen::Vector3d(x, y, z);
        const Rigid3d pose = Perturb(scenes.start, delta);
        cells.push_back({pose, scenes.At(kGridLevel, pose).value});
      }
    }
  }
  std::ranges::stable_sort(cells, std::ranges::greater{}, &Climbed::score);
  std::vector<Rigid3d> starts = {scenes.start};
  for (const Climbed& cell : cells) {
    const bool is_new = std::ranges::none_of(starts, [&](const Rigid3d& other) {
      return DistanceBetween(cell.pose, other).rotation_rad < 1.5 * kGridStep_rad;
    });
    if (is_new) starts.push_back(cell.pose);
    if (starts.size() > kStarts) break;
  }
  return starts;
}

// What edges of the same scenes score where nothing coincides but by chance.
void MeasureChance(std::span<const ScenePair> pairs, SceneFit& fit) {
  double sum = 0.0;
  double squares = 0.0;
  int count = 0;
  for (int i = 0; i < 32; ++i) {
    // Directions on a spiral of the sphere, at 2.5 to 5 degrees.
    const double height = 1.0 - (2.0 * i + 1.0) / 32.0;
    const double turn = 2.4 * i;
    const double level = std::sqrt(1.0 - height * height);
    const double angle = (2.5 + 2.5 * i / 31.0) * kRadPerDeg;
    Vector6d delta = Vector6d::Zero();
    delta.head<3>() =
        angle * Eigen::Vector3d(level * std::cos(turn), level * std::sin(turn), height);
    const double score = ScoreScenes(pairs, kComparing, Perturb(fit.cam_from_lidar, delta)).value;
    sum += score;
    squares += score * score;
    ++count;
  }
  fit.chance_mean = sum / count;
  fit.chance_sigma =
      std::sqrt(std::max(1e-12, squares / count - fit.chance_mean * fit.chance_mean));
}

// Coarse levels need no more edges than determine the pose.
std::size_t StrideOf(std::span<const ScenePair> pairs) {
  constexpr std::size_t kEnough = 3000;
  std::size_t edges = 0;
  for (const ScenePair& pair : pairs) edges += pair.edges.size();
  return std::max<std::size_t>(1, edges / kEnough);
}

// What optima that are as good as the best by chance add to the covariance.
Matrix6d SpreadOfRivals(std::span<const Climbed> optima, const Climbed& highest,
                        double chance_sigma) {
  constexpr double kComparable = 1.5;
  Matrix6d spread = Matrix6d::Zero();
  double weights = 1.0;
  for (const Climbed& other : optima) {
    const double below = std::max(0.0, (highest.score - other.score) / chance_sigma);
    const PoseDistance apart = DistanceBetween(other.pose, highest.pose);
    const bool is_new = apart.rotation_rad > 0.05 * kRadPerDeg || apart.translation_m > 0.01;
    if (below > kComparable || !is_new) continue;
    const Vector6d difference = PoseDifference(other.pose, highest.pose);
    spread += std::exp(-below) * difference * difference.transpose();
    weights += std::exp(-below);
  }
  return spread / weights;
}

// The spread of the optimum over the tiles, with the floor.
Matrix6d SpreadOfTiles(const Objective& scenes, SceneFit& fit) {
  const Vector6d scale = ScaleOf(scenes, 0);
  const Matrix6d inverse = BoundedInverse(CurvatureOf(scenes, 0, fit.cam_from_lidar, scale), 1e-3);
  Matrix6d spread = Matrix6d::Zero();
  for (const SceneScore& tile : ScoreTiles(scenes.pairs, 0, fit.cam_from_lidar)) {
    if (tile.value == 0.0) continue;
    const Vector6d gradient = tile.gradient.cwiseProduct(scale);
    spread += gradient * gradient.transpose();
    ++fit.tiles;
  }
  const double correction = fit.tiles > 8 ? fit.tiles / (fit.tiles - 6.0) : 4.0;
  const Matrix6d scaled = correction * (inverse * spread * inverse);
  Matrix6d covariance = scale.asDiagonal() * scaled * scale.asDiagonal();
  Vector6d floor;
  floor << Eigen::Vector3d::Constant(kFloorRotation_rad),
      Eigen::Vector3d::Constant(kFloorTranslation_m);
  covariance.diagonal() += floor.cwiseAbs2();
  return covariance;
}

// The optimum nearest to the start among those that are as good as the best up to chance.
const Climbed& NearestOfBest(std::span<const Climbed> optima, const Rigid3d& start,
                             double chance_sigma) {
  const double highest = std::ranges::max_element(optima, {}, &Climbed::score)->score;
  const Climbed* nearest = nullptr;
  double least = 0.0;
  for (const Climbed& optimum : optima) {
    const PoseDistance apart = DistanceBetween(optimum.pose, start);
    const double distance = apart.rotation_rad + apart.translation_m / kTypicalDepth_m;
    if (highest - optimum.score > chance_sigma) continue;
    if (nearest != nullptr && distance >= least) continue;
    nearest = &optimum;
    least = distance;
  }
  return *nearest;
}

}  // namespace

SceneFit SearchScenes(std::span<const ScenePair> pairs, const Rigid3d& start,
                      const ProgressCallback& progress) {
  const Objective scenes{pairs, start, StrideOf(pairs)};
  const std::vector<Rigid3d> starts = GridStarts(scenes);
  ProgressCounter counter(progress, "search", starts.size());
  std::vector<Climbed> optima = {Climb(scenes, start, kComparing, kComparing)};
  for (const Rigid3d& from : starts) {
    optima.push_back(Climb(scenes, from, kGridLevel, kComparing));
    counter.Step();
  }
  counter.Finish();
  SceneFit fit;
  fit.cam_from_lidar = std::ranges::max_element(optima, {}, &Climbed::score)->pose;
  MeasureChance(pairs, fit);
  const Climbed& best = NearestOfBest(optima, start, fit.chance_sigma);
  fit.cam_from_lidar = Climb(scenes, best.pose, 0, 0).pose;
  fit.score = best.score;
  fit.start_score = scenes.At(kComparing, start).value;
  fit.edges = EdgesInView(pairs, fit.cam_from_lidar);
  fit.scenes = DistinctScenes(pairs);
  fit.own_covariance = SpreadOfTiles(scenes, fit);
  fit.covariance = fit.own_covariance + SpreadOfRivals(optima, best, fit.chance_sigma);
  return fit;
}

}  // namespace sextant
