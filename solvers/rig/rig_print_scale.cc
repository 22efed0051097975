// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/rig_print_scale.h"

#include <cmath>
#include <limits>
#include <map>

namespace sextant {
namespace {

constexpr double kFreeScale = 0.2;

// A print that is larger by a share s appears as one that is nearer: at (R, t / (1 + s)), as a
// projection does not depend on the scale of the scene.
void AddScales(const RigState& at, RigModel& model) {
  std::map<std::size_t, std::size_t> number_of;
  RigResiduals residuals;
  for (RigBlock& block : model.blocks) {
    if (block.kind != RigKind::kPrinted) continue;
    const Rigid3d pose = SensorFromBoardOf(model, at, block);
    if (!block.residuals(pose, residuals)) continue;
    const auto [number, is_new] = number_of.try_emplace(block.sensor, model.numbers.size());
    if (is_new) model.numbers.push_back({block.sensor, "print_scale", kFreeScale, false});
    const Eigen::VectorXd by = -residuals.by_pose.rightCols<3>() * pose.translation;
    block.numbers.push_back({number->second, by});
  }
}

}  // namespace

std::vector<RigPrintScale> PrintScalesNear(const RigModel& model, const RigAnswer& answer,
                                           const RigOptions& options) {
  RigModel scaled = model;
  AddScales(answer.state, scaled);
  if (scaled.numbers.size() == model.numbers.size()) return {};
  RigState start = answer.state;
  start.numbers.resize(scaled.numbers.size(), 0.0);
  RigMinimum minimum(scaled, options.root, start);
  minimum.SetWeights(WeightsFor(scaled, start, UnitsAt(scaled, start), answer.selection,
                                answer.noise, std::numeric_limits<double>::infinity()));
  constexpr double kEnough = 1e-6;
  if (!minimum.Solve(options.max_iterations, kEnough).converged) return {};
  const auto information = RigInformationOf(minimum.Linearise());
  if (!information) return {};
  const auto poses = 6 * (static_cast<Eigen::Index>(scaled.sensors) - 1);
  std::vector<RigPrintScale> scales;
  for (std::size_t k = model.numbers.size(); k < scaled.numbers.size(); ++k) {
    const auto at = poses + static_cast<Eigen::Index>(k);
    scales.push_back({scaled.numbers[k].sensor, minimum.state().numbers[k],
                      std::sqrt(information->covariance(at, at))});
  }
  return scales;
}

}  // namespace sextant
