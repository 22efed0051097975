// SPDX-License-Identifier: Apache-2.0
// Extraction of two boards from a full LiDAR revolution: from the point cloud to the corners with
// the extractor for boards of known size. One thread. The corners are checked against the truth
// before timing.
#include <benchmark/benchmark.h>

#include "base/random.h"
#include "eval/extractors/board_scenes.h"
#include "features/lidar/corner_extractor.h"
#include "simulator/lidar/scan.h"

namespace sextant {
namespace {

constexpr double kMaxError_m = 0.02;

Expected<std::vector<LidarCorners>> Extract(const PointCloud& cloud,
                                            const std::vector<Board>& boards,
                                            const BoardSearchOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const ScanRings rings, ScanRings::Build(cloud));
  SEXTANT_ASSIGN_OR_RETURN(const BoardSearch search, FindBoards(rings, boards, options));
  std::vector<LidarCorners> corners;
  for (const BoardPatch& patch : search.found) {
    SEXTANT_ASSIGN_OR_RETURN(
        LidarCorners of,
        ExtractCorners("rectangle", patch, boards[static_cast<std::size_t>(patch.board)]));
    corners.push_back(std::move(of));
  }
  return corners;
}

void TwoBoards(benchmark::State& state, const char* lidar) {
  const LidarModel model = *FindLidarModel(lidar);
  Random random(1);
  const Scene scene = TwoBoardsInRoom(FieldOf(model, 1.8), random);
  const std::vector<Board> boards = BoardsIn(scene);
  const Expected<SimulatedScan> scan = SimulateScan(scene, model, {.seed = 1});
  if (!scan) return state.SkipWithError(scan.error().message.c_str());
  BoardSearchOptions options;
  options.beam = *FindLidarBeam(lidar);
  const Expected<std::vector<LidarCorners>> checked = Extract(scan->cloud, boards, options);
  if (!checked || checked->size() != 2) return state.SkipWithError("a board was not found");
  for (const LidarCorners& corners : *checked) {
    const SceneBoard& board = scene.boards[static_cast<std::size_t>(corners.board)];
    for (int i = 0; i < kCornersPerBoard; ++i) {
      const Eigen::Vector3d& corner = corners.in_lidar[static_cast<std::size_t>(i)];
      if ((corner - TrueCorner(board, i)).norm() > kMaxError_m) {
        return state.SkipWithError("a corner is wrong");
      }
    }
  }
  for (auto _ : state) benchmark::DoNotOptimize(Extract(scan->cloud, boards, options));
  state.counters["points"] = static_cast<double>(scan->cloud.points.size());
}

BENCHMARK_CAPTURE(TwoBoards, vlp16, "vlp16")
    ->Name("boards_in_scan/vlp16/2")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(TwoBoards, hdl64e, "hdl64e")
    ->Name("boards_in_scan/hdl64e/2")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(TwoBoards, os1_64, "os1_64")
    ->Name("boards_in_scan/os1_64/2")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(TwoBoards, os1_128, "os1_128")
    ->Name("boards_in_scan/os1_128/2")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(TwoBoards, livox, "livox")
    ->Name("boards_in_scan/livox/2")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sextant

BENCHMARK_MAIN();
