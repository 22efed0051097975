// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "cli/commands.h"
#include "cli/load.h"
#include "io/problems/problem_yaml.h"
#include "io/text/text_file.h"

namespace sextant::cli {

int RunSimulatePairs(const SimulatePairsOptions& options) {
  const PairSimulation& simulation = options.simulation;
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
  fmt::print("{}: {} pairs of corners, {} of them displaced; the truth is in the file\n",
             options.out, session->problem.pairs_3d3d.size(), simulation.outliers);
  return kAnswered;
}

}  // namespace sextant::cli
