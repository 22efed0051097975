// SPDX-License-Identifier: Apache-2.0
#include "calibrate/scene/scene_search.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "base/units.h"
#include "calibrate/scene/scene_climb.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr double kGridStep_rad = 0.5 * kRadPerDeg;
constexpr int kGridHalf = 4;
constexpr int kGridLevel = 2;
constexpr std::size_t kStarts = 12;
constexpr int kComparing = 1;  // The level at which optima are compared.
constexpr double kFloorRotation_rad = 0.05 * kRadPerDeg;
constexpr double kFloorTranslation_m = 0.012;
constexpr double kFloorIntrinsics = 0.002;

struct Climbed {
  Rigid3d pose;
  double score = 0.0;
};

Climbed ClimbFrom(const SceneObjective& scenes, const Rigid3d& pose, int from_level) {
  const SceneModel model = Climb(scenes, {.cam_from_lidar = pose}, from_level, kComparing);
  return {model.cam_from_lidar, scenes.At(kComparing, model).value};
}

// The cells of a grid of rotations around the start.
std::vector<Rigid3d> GridCells(const Rigid3d& start) {
  std::vector<Rigid3d> cells;
  for (int x = -kGridHalf; x <= kGridHalf; ++x) {
    for (int y = -kGridHalf; y <= kGridHalf; ++y) {
      for (int z = -kGridHalf; z <= kGridHalf; ++z) {
        Vector6d delta = Vector6d::Zero();
        delta.head<3>() = kGridStep_rad * Eigen::Vector3d(x, y, z);
        cells.push_back(Perturb(start, delta));
      }
    }
  }
  return cells;
}

// The best cells of the grid, none a neighbour of another; the start is the first.
std::vector<Rigid3d> GridStarts(const SceneObjective& scenes, std::size_t count) {
  const Rigid3d& start = scenes.start.cam_from_lidar;
  const std::vector<Rigid3d> grid = GridCells(start);
  std::vector<Climbed> cells(grid.size());
  tbb::parallel_for(std::size_t{0}, grid.size(), [&](std::size_t i) {
    cells[i] = {grid[i], scenes.At(kGridLevel, {.cam_from_lidar = grid[i]}).value};
  });
  std::ranges::stable_sort(cells, std::ranges::greater{}, &Climbed::score);
  std::vector<Rigid3d> starts = {start};
  for (const Climbed& cell : cells) {
    const bool is_new = std::ranges::none_of(starts, [&](const Rigid3d& other) {
      return DistanceBetween(cell.pose, other).rotation_rad < 1.5 * kGridStep_rad;
    });
    if (is_new) starts.push_back(cell.pose);
    if (starts.size() > count) break;
  }
  return starts;
}

// What edges of the same scenes score where nothing coincides but by chance.
struct Chance {
  double mean = 0.0;
  double sigma = 0.0;

  double Contrast(double score) const { return (score - mean) / sigma; }
};

Chance ChanceAround(std::span<const ScenePair> pairs, const Rigid3d& pose) {
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
    const double score =
        ScoreScenes(pairs, kComparing, {.cam_from_lidar = Perturb(pose, delta)}).value;
    sum += score;
    squares += score * score;
    ++count;
  }
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(1e-12, squares / count - mean * mean))};
}

// Coarse levels need no more edges than determine the pose.
std::size_t StrideOf(std::span<const ScenePair> pairs, std::size_t enough) {
  std::size_t edges = 0;
  for (const ScenePair& pair : pairs) edges += pair.edges.size();
  return std::max<std::size_t>(1, edges / enough);
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

struct TileSpread {
  Matrix9d covariance = Matrix9d::Zero();
  int tiles = 0;
};

// The spread of the optimum over the tiles, with the floor.
TileSpread SpreadOfTiles(const SceneObjective& scenes, const SceneModel& model) {
  const Vector9d scale = ScaleOf(scenes, 0);
  const Matrix9d inverse = BoundedInverse(CurvatureOf(scenes, 0, model, scale), 1e-3);
  Matrix9d spread = Matrix9d::Zero();
  TileSpread result;
  for (const SceneScore& tile : ScoreTiles(scenes.pairs, 0, model)) {
    if (tile.value == 0.0) continue;
    const Vector9d gradient = tile.gradient.cwiseProduct(scale);
    spread += gradient * gradient.transpose();
    ++result.tiles;
  }
  const double correction = result.tiles > 8 ? result.tiles / (result.tiles - 6.0) : 4.0;
  const Matrix9d scaled = correction * (inverse * spread * inverse);
  Vector9d floor;
  floor << Eigen::Vector3d::Constant(kFloorRotation_rad),
      Eigen::Vector3d::Constant(kFloorTranslation_m), Eigen::Vector3d::Constant(kFloorIntrinsics);
  result.covariance = scale.asDiagonal() * scaled * scale.asDiagonal();
  result.covariance.diagonal() += floor.cwiseAbs2();
  return result;
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

// The optimum next to the start, then those from every other one, coarse to fine.
std::vector<Climbed> OptimaOf(const SceneObjective& scenes, const std::vector<Rigid3d>& starts,
                              const std::function<void()>& step) {
  std::vector<Climbed> optima(starts.size() + 1);
  optima[0] = ClimbFrom(scenes, scenes.start.cam_from_lidar, kComparing);
  tbb::parallel_for(std::size_t{0}, starts.size(), [&](std::size_t i) {
    optima[i + 1] = ClimbFrom(scenes, starts[i], kGridLevel);
    if (step) step();
  });
  return optima;
}

// The best pose of some of the scenes, by a search that knows nothing of the others.
Rigid3d BestOf(std::span<const ScenePair> pairs, const Rigid3d& start) {
  constexpr std::size_t kEnough = 1000;
  constexpr std::size_t kFewStarts = 3;
  const SceneObjective scenes{
      .pairs = pairs, .start = {.cam_from_lidar = start}, .stride = StrideOf(pairs, kEnough)};
  const std::vector<Climbed> optima = OptimaOf(scenes, GridStarts(scenes, kFewStarts), {});
  const Rigid3d& best = std::ranges::max_element(optima, {}, &Climbed::score)->pose;
  return Climb(scenes, {.cam_from_lidar = best}, 0, 0).cam_from_lidar;
}

// What the halves of the scenes show of each other.
void CompareHalves(std::span<const ScenePair> pairs, const Rigid3d& start, SceneFit& fit) {
  const std::array<std::vector<ScenePair>, 2> halves = HalvesOf(pairs, fit.cam_from_lidar);
  std::array<Rigid3d, 2> poses;
  tbb::parallel_for(std::size_t{0}, std::size_t{2},
                    [&](std::size_t half) { poses[half] = BestOf(halves[half], start); });
  double sum = 0.0;
  for (std::size_t half = 0; half < 2; ++half) {
    const Rigid3d& pose = poses[1 - half];
    const double score = ScoreScenes(halves[half], kComparing, {.cam_from_lidar = pose}).value;
    sum += ChanceAround(halves[half], pose).Contrast(score);
  }
  fit.held_out = sum / std::sqrt(2.0);
  fit.halves_distance =
      SquaredMahalanobis<6>(PoseDifference(poses[0], poses[1]), Matrix6d(4.0 * fit.covariance));
}

// The best pose and intrinsics from either the start or the fit, and the best intrinsics alone.
void FitIntrinsics(SceneObjective scenes, SceneFit& fit) {
  scenes.unknowns = SceneUnknowns::kIntrinsics;
  const SceneModel only = Climb(scenes, scenes.start, EdgeFields::kLevels - 1, kComparing);
  fit.only_intrinsics = only.intrinsics;
  fit.only_intrinsics_score = scenes.At(kComparing, only).value;
  scenes.unknowns = SceneUnknowns::kBoth;
  const SceneModel fitted{.cam_from_lidar = fit.cam_from_lidar};
  for (const SceneModel& from : {only, fitted}) {
    const SceneModel model = Climb(scenes, from, EdgeFields::kLevels - 1, kComparing);
    const double score = scenes.At(kComparing, model).value;
    if (fit.free_score != 0.0 && score <= fit.free_score) continue;
    fit.free = model;
    fit.free_score = score;
  }
  fit.free = Climb(scenes, fit.free, 0, 0);
  fit.free_covariance = SpreadOfTiles(scenes, fit.free).covariance;
}

}  // namespace

SceneFit SearchScenes(std::span<const ScenePair> pairs, const Rigid3d& start,
                      const ProgressCallback& progress) {
  constexpr std::size_t kEnough = 3000;
  const SceneObjective scenes{
      .pairs = pairs, .start = {.cam_from_lidar = start}, .stride = StrideOf(pairs, kEnough)};
  const std::vector<Rigid3d> starts = GridStarts(scenes, kStarts);
  ProgressCounter counter(progress, "search", starts.size() + 2);
  const std::vector<Climbed> optima = OptimaOf(scenes, starts, [&counter] { counter.Step(); });
  SceneFit fit;
  const Rigid3d highest = std::ranges::max_element(optima, {}, &Climbed::score)->pose;
  const Chance chance = ChanceAround(pairs, highest);
  fit.chance_mean = chance.mean;
  fit.chance_sigma = chance.sigma;
  const Climbed& best = NearestOfBest(optima, start, chance.sigma);
  const SceneModel finest = Climb(scenes, {.cam_from_lidar = best.pose}, 0, 0);
  fit.cam_from_lidar = finest.cam_from_lidar;
  fit.score = best.score;
  fit.start_score = scenes.At(kComparing, scenes.start).value;
  fit.focal_px = pairs.front().camera.fx_px;
  fit.edges = EdgesInView(pairs, fit.cam_from_lidar);
  fit.scenes = DistinctScenes(pairs);
  const TileSpread spread = SpreadOfTiles(scenes, finest);
  fit.tiles = spread.tiles;
  fit.own_covariance = spread.covariance.topLeftCorner<6, 6>();
  fit.covariance = fit.own_covariance + SpreadOfRivals(optima, best, chance.sigma);
  CompareHalves(pairs, start, fit);
  counter.Step();
  FitIntrinsics(scenes, fit);
  counter.Step();
  counter.Finish();
  return fit;
}

}  // namespace sextant
