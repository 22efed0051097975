// SPDX-License-Identifier: Apache-2.0
#include "eval/extractors/extractor_study.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/median.h"
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

constexpr const char* kExtractorExperiment = "extractors";
constexpr double kNearest_m = 1.2;
constexpr double kFurthest_m = 4.2;  // The rooms' walls are 5 m away.
constexpr double kMaxOff = 1.0 / 3.0;
enum Part : std::uint64_t { kAccuracy, kPlacement, kRoom };

struct ScanTrial {
  Part part = kAccuracy;
  int index = 0;
};

struct CornerError {
  std::size_t extractor = 0;
  bool refused = false;
  std::vector<double> distances_m{};
  double outward_m = 0.0;
  double nees = 0.0;
};

struct ScanOutcome {
  int due = 0;
  int found = 0;
  int misplaced = 0;
  int boards = 0;  // Boards found in a room without one.
  std::vector<CornerError> errors{};
};

// For each board, whether enough rings or returns hit it that it must be found.
std::vector<bool> AreDue(const SimulatedScan& scan, std::size_t boards) {
  std::vector<int> returns(boards, 0);
  std::vector<std::map<int, int>> rings(boards);
  for (std::size_t i = 0; i < scan.truth.size(); ++i) {
    if (scan.truth[i].object != SceneObject::kBoard) continue;
    const auto board = static_cast<std::size_t>(scan.truth[i].index);
    ++returns[board];
    if (!scan.cloud.ring.empty()) ++rings[board][scan.cloud.ring[i]];
  }
  std::vector<bool> due;
  for (std::size_t b = 0; b < boards; ++b) {
    int crossing = 0;
    for (const auto& [ring, count] : rings[b]) crossing += count >= 2 ? 1 : 0;
    due.push_back(scan.cloud.ring.empty() ? returns[b] >= kReturnsDue : crossing >= kRingsDue);
  }
  return due;
}

class Study {
 public:
  Study(const ExtractorStudyOptions& options, LidarModel model, const LidarBeam& beam)
      : options_(options), model_(std::move(model)), beam_(beam) {
    model_.range_sigma_m = options.range_sigma_m;
    model_.dim_sigma_m = std::max(model_.dim_sigma_m, model_.range_sigma_m);
    model_.ring_bias_sigma_m = 0.0;
  }

  Expected<ScanOutcome> Run(const ScanTrial& trial) const {
    const auto index = static_cast<std::uint64_t>(trial.index);
    Random random(DeriveSeed(options_.seed, kExtractorExperiment, trial.part, index));
    const Scene scene = Draw(trial.part, random);
    SEXTANT_ASSIGN_OR_RETURN(
        const SimulatedScan scan,
        SimulateScan(scene, model_,
                     {.seed = DeriveSeed(options_.seed, model_.name, trial.part, index),
                      .truth = trial.part == kPlacement}));
    SEXTANT_ASSIGN_OR_RETURN(const ScanRings rings, ScanRings::Build(scan.cloud));
    BoardSearchOptions search;
    search.beam = beam_;
    const std::vector<Board> boards =
        trial.part == kRoom ? BoardsIn(TwoBoardsInRoom({}, random)) : BoardsIn(scene);
    SEXTANT_ASSIGN_OR_RETURN(const BoardSearch found, FindBoards(rings, boards, search));
    ScanOutcome outcome;
    if (trial.part == kRoom) outcome.boards = static_cast<int>(found.found.size());
    if (trial.part == kPlacement) Count(scene, scan, found, outcome);
    if (trial.part == kAccuracy) Measure(scene, found, outcome);
    return outcome;
  }

 private:
  Scene Draw(Part part, Random& random) const {
    if (part == kRoom) return FurnishedRoom(random);
    const double distance =
        part == kPlacement ? random.Uniform(kNearest_m, kFurthest_m) : options_.distance_m;
    Scene scene = TwoBoardsInRoom(FieldOf(model_, distance), random);
    for (const SceneBoard& board : std::vector<SceneBoard>(scene.boards)) {
      if (options_.holding == BoardHolding::kOnStand) AddStand(board, scene);
      if (options_.holding == BoardHolding::kInHands) AddHolder(board, random, scene);
    }
    return scene;
  }

  static bool IsPlaced(const Scene& scene, const BoardPatch& patch) {
    const SceneBoard& board = scene.boards[static_cast<std::size_t>(patch.board)];
    const double off =
        (patch.plane.At(patch.fit.center) - board.world_from_board.translation).norm();
    return off < kMaxOff * board.board.top_right_m;
  }

  static void Count(const Scene& scene, const SimulatedScan& scan, const BoardSearch& search,
                    ScanOutcome& outcome) {
    const std::vector<bool> due = AreDue(scan, scene.boards.size());
    outcome.due = static_cast<int>(std::ranges::count(due, true));
    for (const BoardPatch& patch : search.found) {
      if (!IsPlaced(scene, patch)) {
        ++outcome.misplaced;
      } else if (due[static_cast<std::size_t>(patch.board)]) {
        ++outcome.found;
      }
    }
  }

  static void Measure(const Scene& scene, const BoardSearch& search, ScanOutcome& outcome) {
    for (const BoardPatch& patch : search.found) {
      if (!IsPlaced(scene, patch)) continue;
      const SceneBoard& board = scene.boards[static_cast<std::size_t>(patch.board)];
      for (std::size_t e = 0; e < CornerExtractors().size(); ++e) {
        const Expected<LidarCorners> corners =
            ExtractCorners(CornerExtractors()[e].name, patch, board.board);
        CornerError error{.extractor = e, .refused = !corners};
        for (int i = 0; corners && i < kCornersPerBoard; ++i) {
          const Eigen::Vector3d truth = TrueCorner(board, i);
          const Eigen::Vector3d off = corners->in_lidar[static_cast<std::size_t>(i)] - truth;
          const Eigen::Vector3d outward = (truth - board.world_from_board.translation).normalized();
          error.distances_m.push_back(off.norm());
          error.outward_m += outward.dot(off) / kCornersPerBoard;
          error.nees += SquaredMahalanobis(off, corners->CovarianceOf(i)) / 3.0 / kCornersPerBoard;
        }
        outcome.errors.push_back(std::move(error));
      }
    }
  }

  const ExtractorStudyOptions& options_;
  LidarModel model_;
  LidarBeam beam_;
};

ExtractorErrors SummariseExtractor(std::size_t extractor,
                                   const std::vector<ScanOutcome>& outcomes) {
  ExtractorErrors errors{.extractor = CornerExtractors()[extractor].name};
  std::vector<double> distances;
  for (const ScanOutcome& outcome : outcomes) {
    for (const CornerError& error : outcome.errors) {
      if (error.extractor != extractor) continue;
      if (error.refused) {
        ++errors.refused;
        continue;
      }
      ++errors.boards;
      distances.insert(distances.end(), error.distances_m.begin(), error.distances_m.end());
      errors.outward_m += error.outward_m;
      errors.nees += error.nees;
    }
  }
  if (errors.boards == 0) return errors;
  errors.outward_m /= errors.boards;
  errors.nees /= errors.boards;
  double squares = 0.0;
  for (const double distance : distances) squares += distance * distance;
  errors.rmse_m = std::sqrt(squares / static_cast<double>(distances.size()));
  errors.median_m = UpperMedian(distances);
  return errors;
}

Expected<ExtractorStudyRow> StudyModel(const ExtractorStudyOptions& options,
                                       const std::string& name) {
  SEXTANT_ASSIGN_OR_RETURN(const LidarModel model, FindLidarModel(name));
  SEXTANT_ASSIGN_OR_RETURN(const LidarBeam beam, FindLidarBeam(name));
  const Study study(options, model, beam);
  std::vector<ScanTrial> trials;
  for (int i = 0; i < options.trials; ++i) trials.push_back({kAccuracy, i});
  for (int i = 0; i < options.placements; ++i) trials.push_back({kPlacement, i});
  for (int i = 0; i < options.rooms; ++i) trials.push_back({kRoom, i});
  std::vector<Expected<ScanOutcome>> results(trials.size());
  tbb::parallel_for(std::size_t{0}, trials.size(),
                    [&](std::size_t i) { results[i] = study.Run(trials[i]); });
  ExtractorStudyRow row{.model = name};
  std::vector<ScanOutcome> outcomes;
  for (Expected<ScanOutcome>& result : results) {
    if (!result) return tl::unexpected<Error>(result.error());
    row.due += result->due;
    row.found += result->found;
    row.misplaced += result->misplaced;
    row.false_boards += result->boards;
    outcomes.push_back(std::move(*result));
  }
  for (std::size_t e = 0; e < CornerExtractors().size(); ++e) {
    row.extractors.push_back(SummariseExtractor(e, outcomes));
  }
  return row;
}

}  // namespace

Expected<std::vector<ExtractorStudyRow>> StudyExtractors(const ExtractorStudyOptions& options) {
  std::vector<ExtractorStudyRow> rows;
  for (const std::string& name : options.models.empty() ? LidarModelNames() : options.models) {
    SEXTANT_ASSIGN_OR_RETURN(ExtractorStudyRow row, StudyModel(options, name));
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string FormatExtractorStudy(const std::vector<ExtractorStudyRow>& rows, bool markdown) {
  TextTable finder({"LiDAR", "boards due", "found", "found [%]", "misplaced", "false"});
  TextTable corners({"LiDAR", "extractor", "boards", "refused", "median [mm]", "RMSE [mm]",
                     "outward [mm]", "NEES"});
  for (const ExtractorStudyRow& row : rows) {
    finder.AddRow({row.model, std::to_string(row.due), std::to_string(row.found),
                   row.due > 0 ? Fixed(100.0 * row.found / row.due, 1) : "-",
                   std::to_string(row.misplaced), std::to_string(row.false_boards)});
    for (const ExtractorErrors& of : row.extractors) {
      const bool any = of.boards > 0;
      corners.AddRow({row.model, of.extractor, std::to_string(of.boards),
                      std::to_string(of.refused), any ? Fixed(kMmPerM * of.median_m, 1) : "-",
                      any ? Fixed(kMmPerM * of.rmse_m, 1) : "-",
                      any ? Fixed(kMmPerM * of.outward_m, 1) : "-", any ? Fixed(of.nees, 2) : "-"});
    }
  }
  return markdown ? finder.Markdown() + "\n" + corners.Markdown()
                  : finder.Plain() + "\n" + corners.Plain();
}

}  // namespace sextant
