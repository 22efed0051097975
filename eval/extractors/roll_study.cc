// SPDX-License-Identifier: Apache-2.0
#include "eval/extractors/roll_study.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "base/random.h"
#include "base/units.h"
#include "eval/extractors/board_scenes.h"
#include "eval/statistics/text_table.h"
#include "features/lidar/corner_extractor.h"
#include "geometry/symmetric.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"

namespace sextant {
namespace {

constexpr const char* kRollExperiment = "rolls";
constexpr double kMinDistance_m = 1.5;
constexpr double kMaxDistance_m = 4.0;
constexpr double kMaxAzimuth_deg = 20.0;
constexpr double kReaches = 2.0;             // Least distance, in half diagonals of the board,
constexpr double kRosetteReaches = 3.0;      // and for a field of view of 38 degrees.
constexpr double kMaxCornerOff = 1.0 / 6.0;  // Relative to the shorter side.

struct RollOutcome {
  bool due = false;
  bool found = false;
  bool misplaced = false;
  double nees = 0.0;
};

bool IsDue(const SimulatedScan& scan) {
  int returns = 0;
  std::map<int, int> rings;
  for (std::size_t i = 0; i < scan.truth.size(); ++i) {
    if (scan.truth[i].object != SceneObject::kBoard) continue;
    ++returns;
    if (!scan.cloud.ring.empty()) ++rings[scan.cloud.ring[i]];
  }
  if (scan.cloud.ring.empty()) return returns >= kRollReturnsDue;
  const auto crossing =
      std::ranges::count_if(rings, [](const auto& ring) { return ring.second >= 2; });
  return crossing >= kRollRingsDue;
}

// Compares with the numbering of the true corners that is nearest: a scan does not show which of
// the placements of an outline is true.
void Measure(const SceneBoard& truth, const LidarCorners& corners, RollOutcome& outcome) {
  const double allowed =
      kMaxCornerOff * std::min(truth.board.top_right_m, truth.board.right_bottom_m);
  double best = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < kCornersPerBoard; ++turn) {
    double worst = 0.0;
    double nees = 0.0;
    for (int i = 0; i < kCornersPerBoard; ++i) {
      const Eigen::Vector3d off = corners.in_lidar[static_cast<std::size_t>(i)] -
                                  TrueCorner(truth, (i + turn) % kCornersPerBoard);
      worst = std::max(worst, off.norm());
      nees += SquaredMahalanobis(off, corners.CovarianceOf(i)) / 3.0 / kCornersPerBoard;
    }
    if (worst >= best) continue;
    best = worst;
    outcome.nees = nees;
  }
  outcome.found = outcome.due && best < allowed;
  outcome.misplaced = best >= allowed;
}

class RollStudy {
 public:
  RollStudy(const RollStudyOptions& options, LidarModel model, const LidarBeam& beam)
      : options_(options), model_(std::move(model)) {
    model_.range_sigma_m = 0.01;
    model_.dim_sigma_m = std::max(model_.dim_sigma_m, model_.range_sigma_m);
    model_.ring_bias_sigma_m = 0.0;
    search_.beam = beam;
  }

  Expected<RollOutcome> Run(int roll, int trial) const {
    const std::uint64_t seed =
        DeriveSeed(options_.seed, kRollExperiment, static_cast<std::uint64_t>(roll),
                   static_cast<std::uint64_t>(trial));
    Random random(seed);
    const Scene scene = Draw(roll, random);
    SEXTANT_ASSIGN_OR_RETURN(const SimulatedScan scan,
                             SimulateScan(scene, model_, {.seed = seed, .truth = true}));
    SEXTANT_ASSIGN_OR_RETURN(const ScanRings rings, ScanRings::Build(scan.cloud));
    const std::vector<Board> boards = BoardsIn(scene);
    SEXTANT_ASSIGN_OR_RETURN(const BoardSearch search, FindBoards(rings, boards, search_));
    RollOutcome outcome{.due = IsDue(scan)};
    if (search.found.empty()) return outcome;
    SEXTANT_ASSIGN_OR_RETURN(const LidarCorners corners,
                             ExtractCorners("rectangle", search.found[0], boards[0]));
    Measure(scene.boards[0], corners, outcome);
    return outcome;
  }

 private:
  Scene Draw(int roll, Random& random) const {
    Board board{.id = 0};
    board.top_right_m = random.Uniform(options_.min_side_m, options_.max_side_m);
    board.right_bottom_m = random.Uniform(options_.min_side_m, options_.max_side_m);
    const double reach = 0.5 * std::hypot(board.top_right_m, board.right_bottom_m);
    // The simulated scanners are a metre above the floor, on which no board may touch.
    RoomPlacement placement{.turn_deg = 180.0 * roll / kRolls};
    const double nearest = (model_.rosette ? kRosetteReaches : kReaches) * reach;
    placement.distance_m = random.Uniform(std::max(kMinDistance_m, nearest), kMaxDistance_m);
    const double aside_deg = MaxAzimuth(reach / placement.distance_m);
    placement.azimuth_deg = random.Uniform(-aside_deg, aside_deg);
    const double lowest = std::min(0.0, reach - 0.9);
    placement.height_m = FieldOf(model_, placement.distance_m).height_m;
    placement.height_m = std::max(placement.height_m + random.Uniform(-0.1, 0.1), lowest);
    placement.yaw_deg = random.Uniform(-30.0, 30.0);
    placement.pitch_deg = random.Uniform(-15.0, 15.0);
    Scene scene = TwoBoardsInRoom({}, random);
    scene.boards = {PlaceBoard(board, placement)};
    const SceneBoard placed = scene.boards[0];
    if (options_.holding == BoardHolding::kOnStand) AddStand(placed, scene);
    if (options_.holding == BoardHolding::kInHands) AddHolder(placed, random, scene);
    return scene;
  }

  // A rosette sees a circle, in which the board must lie: what is outside is not due.
  double MaxAzimuth(double tangent_of_reach) const {
    if (!model_.rosette) return kMaxAzimuth_deg;
    const double half_view_rad = 2.0 * model_.rosette->deflection_rad;
    const double room_deg = (half_view_rad - std::atan(tangent_of_reach)) / kRadPerDeg;
    return std::clamp(room_deg, 0.0, kMaxAzimuth_deg);
  }

  const RollStudyOptions& options_;
  LidarModel model_;
  BoardSearchOptions search_;
};

Expected<RollStudyRow> StudyModelRolls(const RollStudyOptions& options, const std::string& name) {
  SEXTANT_ASSIGN_OR_RETURN(const LidarModel model, FindLidarModel(name));
  SEXTANT_ASSIGN_OR_RETURN(const LidarBeam beam, FindLidarBeam(name));
  const RollStudy study(options, model, beam);
  const auto trials = static_cast<std::size_t>(options.trials);
  std::vector<Expected<RollOutcome>> outcomes(kRolls * trials);
  tbb::parallel_for(std::size_t{0}, outcomes.size(), [&](std::size_t i) {
    outcomes[i] = study.Run(static_cast<int>(i / trials), static_cast<int>(i % trials));
  });
  RollStudyRow row{.model = name};
  int level = 0;
  int other = 0;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    if (!outcomes[i]) return tl::unexpected<Error>(outcomes[i].error());
    const std::size_t roll = i / trials;
    row.due[roll] += outcomes[i]->due ? 1 : 0;
    row.found[roll] += outcomes[i]->found ? 1 : 0;
    row.misplaced += outcomes[i]->misplaced ? 1 : 0;
    if (!outcomes[i]->found) continue;
    const bool is_level = roll % (kRolls / 2) == 0;
    (is_level ? row.level_nees : row.other_nees) += outcomes[i]->nees;
    ++(is_level ? level : other);
  }
  row.level_nees /= std::max(1, level);
  row.other_nees /= std::max(1, other);
  return row;
}

}  // namespace

Expected<std::vector<RollStudyRow>> StudyRolls(const RollStudyOptions& options) {
  std::vector<RollStudyRow> rows;
  for (const std::string& name : options.models.empty() ? LidarModelNames() : options.models) {
    SEXTANT_ASSIGN_OR_RETURN(RollStudyRow row, StudyModelRolls(options, name));
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string FormatRollStudy(const std::vector<RollStudyRow>& rows, bool markdown) {
  std::vector<std::string> head = {"LiDAR", "boards due", "found [%]"};
  for (int roll = 0; roll < kRolls; ++roll) {
    head.push_back(fmt::format("{} deg", 180 * roll / kRolls));
  }
  head.insert(head.end(), {"misplaced", "NEES level", "NEES other"});
  TextTable table(head);
  for (const RollStudyRow& row : rows) {
    int due = 0;
    int found = 0;
    std::vector<std::string> cells = {row.model, "", ""};
    for (std::size_t roll = 0; roll < kRolls; ++roll) {
      due += row.due[roll];
      found += row.found[roll];
      cells.push_back(row.due[roll] > 0 ? Fixed(100.0 * row.found[roll] / row.due[roll], 0) : "-");
    }
    cells[1] = std::to_string(due);
    cells[2] = due > 0 ? Fixed(100.0 * found / due, 1) : "-";
    cells.push_back(std::to_string(row.misplaced));
    cells.push_back(Fixed(row.level_nees, 2));
    cells.push_back(Fixed(row.other_nees, 2));
    table.AddRow(std::move(cells));
  }
  return markdown ? table.Markdown() : table.Plain();
}

}  // namespace sextant
