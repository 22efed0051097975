// SPDX-License-Identifier: Apache-2.0
#include "eval/synthetic/simulate_pairs.h"

#include <fmt/core.h>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "io/output/output_file.h"
#include "io/output/standard_output.h"
#include "io/problems/problem_yaml.h"

namespace sextant::cli {
namespace {

struct SimulatePairsOptions {
  PairSimulation simulation{};
  std::string out = "session.yaml";
  GivenOptions given{};
};

void Declare(SimulatePairsOptions& options, Arguments& arguments) {
  PairSimulation& simulation = options.simulation;
  arguments.Add("--out", options.out, "Problem file to write",
                {.shows_default = true, .writes = Writes::kFile});
  arguments.Add("--seed", simulation.seed, "The same seed gives the same bytes",
                {.shows_default = true});
  arguments.Add("--views", simulation.views, "Views, each with the boards in new places",
                {.shows_default = true, .range = {{1, PairSimulation::kMaxViews}}});
  arguments.Add("--outliers", simulation.outliers, "Corners that are displaced",
                {.shows_default = true, .range = {{0, 8 * PairSimulation::kMaxViews}}});
  arguments.Add("--outlier-shift", simulation.outlier_shift_m, "Size of the displacement [m]",
                {.shows_default = true, .range = {{0.0, 1000.0}}});
  arguments.Add("--lidar-sigma", simulation.lidar_sigma_m, "LiDAR corner noise per axis [m]",
                {.shows_default = true, .range = {{0.0, 1000.0}}});
  arguments.Add("--camera-sigma", simulation.camera_lateral_sigma_m,
                "Camera corner noise across the ray [m]",
                {.shows_default = true, .range = {{0.0, 1000.0}}});
  arguments.Add("--depth-sigma", simulation.camera_depth_sigma_m,
                "Camera corner noise along the ray [m]",
                {.shows_default = true, .range = {{0.0, 1000.0}}});
  arguments.Add("--pixel-sigma", simulation.pixel_sigma_px, "Corner noise in the image [px]",
                {.shows_default = true, .range = {{0.0, 1e4}}});
  arguments.ReportGiven(options.given);
}

int Run(const SimulatePairsOptions& options) {
  const PairSimulation& simulation = options.simulation;
  if (simulation.outliers == 0) {
    const Expected<void> ok =
        RefuseGiven(options.given, {"--outlier-shift"}, "is for --outliers, and there are none");
    if (!ok) return Refuse("simulate pairs", ok.error());
  }
  const Expected<SimulatedSession> session = SimulatePairs(simulation);
  if (!session) return Refuse("simulate pairs", session.error());
  const ProblemFile file{
      .problem = session->problem,
      .true_cam_from_lidar = session->true_cam_from_lidar,
      .comment = fmt::format("simulated: the paper's two boards, seed {}, {} views, {} outliers",
                             simulation.seed, simulation.views, simulation.outliers)};
  if (const Expected<void> ok = WriteFileAtomically(options.out, FormatProblemYaml(file)); !ok) {
    return Refuse("simulate pairs", ok.error());
  }
  Print("{}", WroteLine(options.out,
                        fmt::format("{} pairs of corners, {} of them displaced, and the truth",
                                    session->problem.pairs_3d3d.size(), simulation.outliers)));
  return kAnswered;
}

}  // namespace

Command SimulatePairsCommand() {
  return MakeCommand<SimulatePairsOptions>(
      "pairs", "Corners of the paper's two boards, in new places in each view",
      "Example:\n  sextant simulate pairs --views 5 --seed 7 --out session.yaml", Declare, Run);
}

}  // namespace sextant::cli
