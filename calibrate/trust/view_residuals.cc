// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/view_residuals.h"

#include <cmath>

namespace sextant {
namespace {

struct Sum {
  double squares_m2 = 0.0;
  double squares_px2 = 0.0;
  Eigen::Vector3d in_cam = Eigen::Vector3d::Zero();
  int pairs = 0;
  int pixels = 0;
};

}  // namespace

std::map<std::pair<int, int>, BoardResidual> ResidualsByBoard(const CalibrationProblem& problem,
                                                              const Evaluation& evaluation) {
  std::map<std::pair<int, int>, Sum> sums;
  for (std::size_t i = 0; i < problem.pairs_3d3d.size(); ++i) {
    const Pair3d3d& pair = problem.pairs_3d3d[i];
    Sum& sum = sums[{pair.id.view, pair.id.board}];
    sum.squares_m2 += evaluation.per_pair_m[i] * evaluation.per_pair_m[i];
    sum.in_cam += pair.point_in_cam;
    ++sum.pairs;
  }
  for (std::size_t i = 0; i < problem.pairs_2d3d.size(); ++i) {
    const PairId& id = problem.pairs_2d3d[i].id;
    if (i >= evaluation.per_pair_px.size()) break;
    Sum& sum = sums[{id.view, id.board}];
    sum.squares_px2 += evaluation.per_pair_px[i] * evaluation.per_pair_px[i];
    ++sum.pixels;
  }
  std::map<std::pair<int, int>, BoardResidual> residuals;
  for (const auto& [key, sum] : sums) {
    if (sum.pairs == 0) continue;
    BoardResidual& residual = residuals[key];
    residual.rmse_m = std::sqrt(sum.squares_m2 / sum.pairs);
    residual.range_m = sum.in_cam.norm() / sum.pairs;
    const double mean_px2 = sum.pixels > 0 ? sum.squares_px2 / sum.pixels : INFINITY;
    if (std::isfinite(mean_px2)) residual.rmse_px = std::sqrt(mean_px2);
  }
  return residuals;
}

}  // namespace sextant
