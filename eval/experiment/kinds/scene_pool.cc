// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/kinds/scene_pool.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <map>
#include <mutex>
#include <optional>
#include <tuple>

#include "simulator/camera/render.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"

namespace sextant {
namespace {

Expected<ScenePair> SimulateScenePair(EverydayPlace place, const LidarModel& lidar,
                                      std::uint64_t seed, Rigid3d& cam_from_lidar) {
  const Scene scene = EverydayScene(place, seed);
  const SceneCamera& camera = scene.cameras.front();
  cam_from_lidar = camera.world_from_cam.Inverse() * scene.lidar.world_from_lidar;
  SEXTANT_ASSIGN_OR_RETURN(const SimulatedScan scan, SimulateScan(scene, lidar, {.seed = seed}));
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat grey, RenderImage(scene, 0, UsualImageOptions(seed, 0.0)));
  return MakeScenePair(grey, scan.cloud, camera.intrinsics, cam_from_lidar);
}

Expected<std::shared_ptr<const ScenePool>> SimulatePool(EverydayPlace place,
                                                        const LidarModel& lidar, int count) {
  auto pool = std::make_shared<ScenePool>();
  std::vector<std::optional<Expected<ScenePair>>> made(static_cast<std::size_t>(count));
  std::vector<Rigid3d> poses(made.size());
  // Isolated: a thread that waits here must not take another trial, which waits for this pool.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(std::size_t{0}, made.size(), [&](std::size_t i) {
      made[i] = SimulateScenePair(place, lidar, i + 1, poses[i]);
    });
  });
  for (std::optional<Expected<ScenePair>>& pair : made) {
    if (!*pair) return tl::unexpected<Error>(pair->error());
    pool->pairs.push_back(std::move(**pair));
  }
  pool->cam_from_lidar = poses.front();
  return pool;
}

}  // namespace

Expected<std::shared_ptr<const ScenePool>> PoolOf(EverydayPlace place,
                                                  const std::string& lidar_model, int count) {
  using Key = std::tuple<EverydayPlace, std::string, int>;
  static std::mutex mutex;
  static std::map<Key, std::weak_ptr<const ScenePool>> pools;
  const std::string name = lidar_model.empty() ? EverydayScene(place, 1).lidar.model : lidar_model;
  SEXTANT_ASSIGN_OR_RETURN(const LidarModel lidar, FindLidarModel(name));
  const std::scoped_lock lock(mutex);
  std::weak_ptr<const ScenePool>& known = pools[{place, name, count}];
  if (auto pool = known.lock()) return pool;
  Expected<std::shared_ptr<const ScenePool>> pool = SimulatePool(place, lidar, count);
  if (pool) known = *pool;
  return pool;
}

}  // namespace sextant
