// SPDX-License-Identifier: Apache-2.0
#include "eval/extractors/scan_pairs.h"

#include <numbers>
#include <utility>

#include "base/random.h"
#include "eval/extractors/board_scenes.h"
#include "geometry/random_vectors.h"
#include "geometry/so3.h"

namespace sextant {
Expected<ScanPair> ScanTwice(Scene scene, const LidarModel& model, std::uint64_t seed,
                             const ScanPairOptions& options) {
  Random random(DeriveSeed(seed, "scan pair", 0, 0));
  ScanPair pair;
  const Eigen::Vector3d turn_rad =
      options.turn_deg * std::numbers::pi / 180.0 * NormalVector(random).normalized();
  pair.target_from_source.rotation = ExpSo3(turn_rad);
  pair.target_from_source.translation = options.move_m * NormalVector(random).normalized();
  ScanOptions scan = options.scan;
  scan.seed = seed;
  for (const bool is_source : {false, true}) {
    scan.scan_index = is_source ? 1 : 0;
    scene.lidar.world_from_lidar = is_source ? pair.target_from_source : Rigid3d{};
    SEXTANT_ASSIGN_OR_RETURN(SimulatedScan made, SimulateScan(scene, model, scan));
    (is_source ? pair.in_source : pair.in_target) = std::move(made.cloud.points);
  }
  return pair;
}

Expected<ScanPair> ScanRoomTwice(const LidarModel& model, std::uint64_t seed,
                                 const ScanPairOptions& options) {
  Random random(DeriveSeed(seed, "room", 0, 0));
  return ScanTwice(FurnishedRoom(random), model, seed, options);
}

}  // namespace sextant
