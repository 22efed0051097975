// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "calibrate/observe/board_scale.h"
#include "eval/experiment/kinds/problem_trials.h"
#include "eval/synthetic/simulate_views.h"

namespace sextant {
namespace {

struct BoardViewsSettings : ViewSimulation, PoseLimits {
  double size_error = 0.0;
};

// Converts members of ViewSimulation to members of BoardViewsSettings, as OptionSet requires.
template <class T>
T BoardViewsSettings::*Of(T ViewSimulation::*member) {
  return member;
}

const OptionSet<BoardViewsSettings>& BoardViewsParameters() {
  static const OptionSet<BoardViewsSettings> set = AddPoseLimits(
      OptionSet<BoardViewsSettings>()
          .Count("views", Of(&ViewSimulation::views), 1, 1000,
                 "number of views, each with a new pose of the board")
          .Real("board_side_m", Of(&ViewSimulation::board_side_m), "m", 0.05, 10.0,
                "side of the square board")
          .Real("tag_edge_m", Of(&ViewSimulation::tag_edge_m), "m", 0.01, 10.0,
                "edge of the tag in the board's centre")
          .Real("nearest_m", Of(&ViewSimulation::nearest_m), "m", 0.1, 1e3,
                "minimum distance of the board")
          .Real("farthest_m", Of(&ViewSimulation::farthest_m), "m", 0.1, 1e3,
                "maximum distance of the board")
          .Count("rings", Of(&ViewSimulation::rings), 1, 1024, "rings of the LiDAR")
          .Real("ring_step_deg", Of(&ViewSimulation::ring_step_deg), "deg", 0.01, 30.0,
                "elevation step between rings")
          .Real("azimuth_step_deg", Of(&ViewSimulation::azimuth_step_deg), "deg", 0.001, 10.0,
                "azimuth step between points of a ring")
          .Real("range_sigma_m", Of(&ViewSimulation::range_sigma_m), "m", 1e-9, 1.0,
                "range noise of a point, along its ray")
          .Real("edge_sigma_m", Of(&ViewSimulation::edge_sigma_m), "m", 1e-9, 1.0,
                "error of the edge points, where a ring leaves the board")
          .Real("pixel_sigma_px", Of(&ViewSimulation::pixel_sigma_px), "px", 1e-9, 100.0,
                "noise of a tag's corner, per axis")
          .Real("size_error", &BoardViewsSettings::size_error, "1", -0.5, 0.5,
                "relative error of the stated sizes of board and tag; positive: stated too large"));
  return set;
}

// Scales everything that depends on the stated size: with a wrong size the camera sees the board at
// a wrong distance.
void StateWrongSize(double share, CalibrationProblem& problem) {
  const double scale = 1.0 + share;
  for (Board& board : problem.boards) {
    ScaleOutline(scale, board);
    ScalePrint(scale, board);
  }
  for (BoardView& view : problem.board_views) {
    view.cam_from_board.translation *= scale;
    for (BoardPoints& printed : view.printed) {
      for (Eigen::Vector2d& point : printed.in_board_m) point *= scale;
    }
  }
  for (Pair3d3d& pair : problem.pairs_3d3d) pair.point_in_cam *= scale;
  for (Eigen::Vector3d& point : problem.point_sets.in_cam) point *= scale;
}

Expected<KnownProblem> MakeBoardViewsProblem(const BoardViewsSettings& settings,
                                             const TrialId& id) {
  ViewSimulation simulation = settings;
  simulation.seed = id.seed;
  SEXTANT_ASSIGN_OR_RETURN(SimulatedViews views, SimulateViews(simulation));
  KnownProblem known;
  known.cam_from_lidar = views.true_cam_from_lidar;
  known.cam_from_board = std::move(views.true_cam_from_board);
  known.inliers = views.problem;
  known.problem = std::move(views.problem);
  if (settings.size_error != 0.0) StateWrongSize(settings.size_error, known.problem);
  return known;
}

Expected<TrialsPtr> MakeBoardViewsTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(BoardViewsSettings settings,
                           BoardViewsParameters().Parse(arguments.parameters));
  if (settings.farthest_m < settings.nearest_m) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("farthest_m = {} is below nearest_m = {}", settings.farthest_m,
                                 settings.nearest_m));
  }
  return MakeProblemTrials(
      {[s = settings](const TrialId& id) { return MakeBoardViewsProblem(s, id); }, settings},
      arguments.solvers, arguments.condition);
}

}  // namespace

TrialKind BoardViewsKind() {
  return {.name = "board_views",
          .summary =
              "a board with a tag seen by a camera and a LiDAR with rings: raw observations, and "
              "the corners of an optimal two-stage extractor",
          .parameters = BoardViewsParameters().Describe(),
          .metrics = PoseMetrics(),
          .trials_per_block = 20,
          .make = MakeBoardViewsTrials};
}

}  // namespace sextant
