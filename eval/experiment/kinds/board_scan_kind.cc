// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/random.h"
#include "base/units.h"
#include "eval/experiment/definition/parameter_set.h"
#include "eval/experiment/definition/trials.h"
#include "features/lidar/corner_extractor.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"
#include "simulator/scene/scene.h"
#include "simulator/scene/scene_pose.h"

namespace sextant {
namespace {

struct BoardScanSettings {
  std::string lidar_model = "vlp16";
  std::string extractor{};
  double distance_m = 2.0;
  double side_m = 0.5;
  double yaw_deg = 20.0;
  double pitch_deg = 10.0;
  double roll_deg = 5.0;
  double background_m = 2.0;
};

enum BoardScanMeasured : int {
  kFound,
  kRings,
  kEdgePoints,
  kMinEdgePoints,
  kGapMm,
  kOffMm,
  kEdgeMm,
  kCornerMm,
  kWorstMm,
};

const std::vector<Metric>& BoardScanMetrics() {
  static const std::vector<Metric> metrics = {
      {"found", "whether the board was found and had all four corners"},
      {"rings", "rings that hit the board"},
      {"edge_points", "mean number of edge points of a side"},
      {"fewest_edge_points", "edge points of the side that has fewest"},
      {"gap_mm", "mean shortest distance between neighbouring edge lines"},
      {"off_mm", "mean distance of a corner from the lines that it is taken for the meeting of"},
      {"edge_mm", "mean absolute difference of an edge's length from the true one"},
      {"corner_mm", "RMS distance of the corners from the true ones"},
      {"worst_mm", "largest distance of a corner from its true place"},
  };
  return metrics;
}

const ParameterSet<BoardScanSettings>& BoardScanParameters() {
  static const ParameterSet<BoardScanSettings> set =
      ParameterSet<BoardScanSettings>()
          .Text("lidar_model", &BoardScanSettings::lidar_model, "name", "see sextant list lidars")
          .Text("extractor", &BoardScanSettings::extractor, "name", "only this one; empty: all")
          .Real("distance_m", &BoardScanSettings::distance_m, "m", 0.5, 100.0,
                "from the LiDAR to the board's middle")
          .Real("side_m", &BoardScanSettings::side_m, "m", 0.05, 10.0, "of the square board")
          .Real("yaw_deg", &BoardScanSettings::yaw_deg, "deg", 0.0, 60.0,
                "the board is turned about the vertical by up to this")
          .Real("pitch_deg", &BoardScanSettings::pitch_deg, "deg", 0.0, 60.0, "leans by up to this")
          .Real("roll_deg", &BoardScanSettings::roll_deg, "deg", 0.0, 30.0,
                "and hangs askew from its corner by up to this")
          .Real("background_m", &BoardScanSettings::background_m, "m", 0.5, 100.0,
                "from the board to the wall behind it");
  return set;
}

class BoardScanTrials final : public Trials {
 public:
  BoardScanTrials(const BoardScanSettings& settings, LidarModel lidar)
      : settings_(settings), lidar_(std::move(lidar)) {
    for (const CornerExtractorInfo& info : CornerExtractors()) {
      if (settings.extractor.empty() || settings.extractor == info.name) {
        extractors_.emplace_back(info.name);
      }
    }
  }

  const std::vector<std::string>& subjects() const override { return extractors_; }

  void Run(const TrialId& id, TrialRows& rows) const override {
    const Scene scene = DrawScene(id.seed);
    const std::vector<Board> boards = {scene.boards[0].board};
    const Expected<SimulatedScan> scan = SimulateScan(scene, lidar_, {.seed = id.seed});
    const Expected<ScanRings> rings =
        scan ? ScanRings::Build(scan->cloud) : tl::unexpected<Error>(scan.error());
    for (const bool corrected : {false, true}) {
      std::optional<BoardPatch> patch;
      if (rings) {
        const Expected<BoardSearch> search =
            FindBoards(*rings, boards, {.correct_edges = corrected});
        if (search && !search->found.empty()) patch = search->found[0];
      }
      for (std::size_t k = 0; k < extractors_.size(); ++k) {
        // The paper's extractor takes last returns as they are; ours correct them.
        if (extractors_[k].starts_with("lines3d") == corrected) continue;
        Measure(scene, patch, extractors_[k], rows.Add(static_cast<int>(k)));
      }
    }
  }

 private:
  Scene DrawScene(std::uint64_t seed) const {
    Random random(DeriveSeed(seed, "board", 0, 0));
    const double yaw = random.Uniform(-settings_.yaw_deg, settings_.yaw_deg);
    const double pitch = random.Uniform(-settings_.pitch_deg, settings_.pitch_deg);
    const double roll = 45.0 + random.Uniform(-settings_.roll_deg, settings_.roll_deg);
    const double side = random.Uniform(-0.05, 0.05);
    const double height = random.Uniform(-0.05, 0.05);
    Scene scene;
    scene.name = "one board";
    scene.lidar.model = settings_.lidar_model;
    SceneBoard board;
    board.board = {.id = 0, .top_right_m = settings_.side_m, .right_bottom_m = settings_.side_m};
    board.world_from_board = {
        SceneRotation(SceneAxes::kForwardIsZ,
                      {kRadPerDeg * yaw, kRadPerDeg * pitch, kRadPerDeg * roll}),
        {settings_.distance_m, side, height}};
    scene.boards.push_back(board);
    SceneWall wall{.name = "back", .width_m = 60.0, .height_m = 30.0};
    wall.world_from_wall = {SceneRotation(SceneAxes::kForwardIsZ, {}),
                            {settings_.distance_m + settings_.background_m, 0.0, 0.0}};
    scene.walls.push_back(wall);
    return scene;
  }

  void Measure(const Scene& scene, const std::optional<BoardPatch>& patch,
               const std::string& extractor, MetricValues values) const {
    values.Set(kFound, 0.0);
    if (!patch) return;
    const Board& board = scene.boards[0].board;
    values.Set(kRings, patch->agreement.rings);
    const Expected<LidarCorners> corners = ExtractCorners(extractor, *patch, board);
    if (!corners) return;
    values.Set(kFound, 1.0);
    const std::vector<int>& counts = corners->checks.points_per_edge;
    double points = 0.0;
    for (const int count : counts) points += count;
    values.Set(kEdgePoints, points / static_cast<double>(counts.size()));
    values.Set(kMinEdgePoints, *std::ranges::min_element(counts));
    double gap = 0.0;
    double edge = 0.0;
    double squares = 0.0;
    double worst = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      gap += 0.25e3 * corners->checks.line_gaps_m[i];
      edge += 0.25e3 * std::abs(corners->checks.edge_lengths_m[i] - board.EdgeLengths()[i]);
      const double error = 1e3 * (corners->in_lidar[i] - CornerInLidar(scene, i)).norm();
      squares += 0.25 * error * error;
      worst = std::max(worst, error);
    }
    values.Set(kGapMm, gap);
    values.Set(kOffMm, 0.5 * gap);
    values.Set(kEdgeMm, edge);
    values.Set(kCornerMm, std::sqrt(squares));
    values.Set(kWorstMm, worst);
  }

  static Eigen::Vector3d CornerInLidar(const Scene& scene, std::size_t corner) {
    const Board& board = scene.boards[0].board;
    const double x = corner == 1 || corner == 2 ? 0.5 : -0.5;
    const double y = corner >= 2 ? 0.5 : -0.5;
    return scene.boards[0].world_from_board *
           Eigen::Vector3d(x * board.top_right_m, y * board.right_bottom_m, 0.0);
  }

  BoardScanSettings settings_;
  LidarModel lidar_;
  std::vector<std::string> extractors_;
};

Expected<TrialsPtr> MakeBoardScanTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(const BoardScanSettings settings,
                           BoardScanParameters().Parse(arguments.parameters));
  SEXTANT_ASSIGN_OR_RETURN(LidarModel lidar, FindLidarModel(settings.lidar_model));
  if (!settings.extractor.empty()) {
    if (const auto known = ExtractCorners(settings.extractor, {}, {});
        !known && known.error().code == ErrorCode::kUnknownName) {
      return tl::unexpected<Error>(known.error());
    }
  }
  return std::make_shared<BoardScanTrials>(settings, std::move(lidar));
}

}  // namespace

TrialKind BoardScanKind() {
  return {
      .name = "board_scan",
      .summary = "one board in a simulated scan: its edge points and corners, by each extractor",
      .takes_solvers = false,
      .parameters = BoardScanParameters().Describe(),
      .metrics = BoardScanMetrics(),
      .trials_per_block = 20,
      .make = MakeBoardScanTrials};
}

}  // namespace sextant
