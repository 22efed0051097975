// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/stated_noise.h"

#include <fmt/core.h>

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/median.h"
#include "solvers/core/solver.h"
#include "solvers/kernels/pair_terms.h"
#include "solvers/least_squares/refine_pose.h"
#include "solvers/least_squares/term_derivatives.h"

namespace sextant {
namespace {

constexpr double kUnknowns = 6.0;
constexpr double kNoticeable = 1.25;

// A bound on the sum of squared whitened residuals at the answer, without terms: it is enough for
// nearly all data. Infinite where a pair has a covariance matrix.
double SquaresAt(const CalibrationProblem& problem, PairKind kind, const SolveReport& report) {
  double squares = 0.0;
  for (const int i : report.inliers) {
    const auto index = static_cast<std::size_t>(i);
    if (kind == PairKind::k2d3d) {
      const double r = report.evaluation.per_pair_px[index] / problem.pairs_2d3d[index].sigma_px;
      squares += r * r;
      continue;
    }
    const Pair3d3d& pair = problem.pairs_3d3d[index];
    if (pair.covariance_in_cam) return std::numeric_limits<double>::infinity();
    const double r = report.evaluation.per_pair_m[index] / pair.sigma_m;
    squares += r * r;
  }
  return squares;
}

template <int kResiduals, class Terms>
void AppendSquares(const Terms& terms, const Camera* camera, const Rigid3d& pose,
                   std::vector<double>& squares) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  TermDerivatives<kResiduals> at;
  for (const auto& term : terms) {
    if (Differentiate(term, camera, r, pose.translation, at)) {
      squares.push_back(at.residual.squaredNorm());
    }
  }
}

// The square of k of the header; none where the stated noise or chance explains the residuals.
std::optional<double> VarianceRatio(const PairTerms& terms, PairKind kind, const Rigid3d& answer) {
  constexpr double kMaxChance = 1e-4;
  const int per_pair = ResidualsPerPair(kind);
  const double residuals = per_pair * static_cast<double>(terms.size());
  const double freedom = residuals - kUnknowns;
  // Not at the answer, which need not be the minimum of what the pairs state.
  const RefinedPose there = RefinePose(terms.View(), answer, {});
  const double squares = 2.0 * there.cost;
  std::vector<double> each;
  AppendSquares<3>(terms.View().points, nullptr, there.cam_from_lidar, each);
  AppendSquares<2>(terms.View().pixels, &terms.camera, there.cam_from_lidar, each);
  if (each.empty()) return std::nullopt;
  const double median_of_chi2 = 2.0 * boost::math::gamma_p_inv(0.5 * per_pair, 0.5);
  const double of_most = UpperMedian(each) / (median_of_chi2 * freedom / residuals);
  const double ratio = std::min(squares / freedom, of_most);
  if (!std::isfinite(ratio) || !(ratio > kNoticeable * kNoticeable)) return std::nullopt;
  if (boost::math::gamma_q(0.5 * freedom, 0.5 * squares) > kMaxChance) return std::nullopt;
  return ratio;
}

}  // namespace

void WidenUnderstatedNoise(const CalibrationProblem& problem, const SolverSpec& spec,
                           SolveReport& report) {
  const bool of_points = spec.needs.pairs_3d3d > 0;
  const bool of_pixels = spec.needs.pairs_2d3d > 0;
  if (of_points == of_pixels || spec.needs.board_views > 0 || report.camera) return;
  if (!report.covariance || report.noise) return;
  const PairKind kind = of_points ? PairKind::k3d3d : PairKind::k2d3d;
  const double freedom =
      ResidualsPerPair(kind) * static_cast<double>(report.inliers.size()) - kUnknowns;
  const bool is_known = of_points ? HasKnownNoise(problem.pairs_3d3d.front())
                                  : HasKnownNoise(problem.pairs_2d3d.front());
  if (!is_known || freedom < kUnknowns) return;
  if (SquaresAt(problem, kind, report) <= kNoticeable * kNoticeable * freedom) return;
  PairTerms used;
  used.AssignSubset(MakeTerms(problem, kind), report.inliers);
  const std::optional<double> ratio = VarianceRatio(used, kind, report.cam_from_lidar);
  if (!ratio) return;
  *report.covariance *= *ratio;
  report.warnings.push_back(fmt::format(
      "the residuals of the {} pairs used are {:.1f} times what the pairs state, which chance does "
      "not explain; the sigmas are {:.1f} times those that the stated noise gives. Errors that all "
      "views have in common, as offsets of a LiDAR's rings, add to them",
      report.inliers.size(), std::sqrt(*ratio), std::sqrt(*ratio)));
}

}  // namespace sextant
