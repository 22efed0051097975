// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/rig_board_information.h"

#include <map>
#include <utility>

#include "solvers/rig/rig_start.h"

namespace sextant {
namespace {

double LevelIn(const RigEstimate& estimate, const RigBlock& block) {
  for (const RigNoiseLevel& noise : estimate.noise) {
    if (noise.sensor == block.sensor && noise.kind == block.kind) return noise.level;
  }
  return 1.0;
}

}  // namespace

std::vector<BoardInformation> BoardInformationOf(const RigProblem& problem,
                                                 const RigEstimate& estimate) {
  std::vector<Rigid3d> sensors;
  for (const auto& pose : estimate.sensor_from_root) sensors.push_back(*pose);
  const RigModel model = RigModelOf(problem);
  const RigState state = StateOf(problem, model, sensors);
  std::map<std::pair<std::size_t, std::size_t>, BoardInformation> all;
  RigResiduals at;
  for (const RigBlock& block : model.blocks) {
    const Rigid3d pose = SensorFromBoardOf(model, state, block);
    if (!block.residuals(pose, at)) continue;
    BoardInformation& of = all[{block.placement, block.seen}];
    of.placement = block.placement;
    of.sensor = block.sensor;
    of.sensor_from_board = pose;
    Matrix6d turn = Matrix6d::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = pose.rotation.toRotationMatrix();
    const Eigen::Matrix<double, Eigen::Dynamic, 6> by_board =
        at.by_pose * turn / LevelIn(estimate, block);
    of.in_board += by_board.transpose() * by_board;
  }
  std::vector<BoardInformation> list;
  for (auto& [key, of] : all) list.push_back(std::move(of));
  return list;
}

}  // namespace sextant
