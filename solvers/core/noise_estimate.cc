// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/noise_estimate.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

#include "geometry/symmetric.h"
#include "solvers/core/solver.h"
#include "solvers/least_squares/term_derivatives.h"

namespace sextant {
namespace {

constexpr int kMaxTooFewBoards = 3;

PointTerm UnitTerm(const Pair3d3d& pair) {
  return {pair.point_in_cam, pair.point_in_lidar, Eigen::Matrix3d::Identity()};
}
PixelTerm UnitTerm(const Pair2d3d& pair) { return {pair.pixel, pair.point_in_lidar, 1.0}; }

double LargestNumber(const Pair3d3d& pair) {
  return std::max(pair.point_in_cam.cwiseAbs().maxCoeff(),
                  pair.point_in_lidar.cwiseAbs().maxCoeff());
}
double LargestNumber(const Pair2d3d& pair) { return pair.pixel.cwiseAbs().maxCoeff(); }

// The error that rounding makes in the pairs of an answer, with a margin. No measurement is as
// fine.
template <class Pair>
double RoundingOf(std::span<const Pair> pairs, std::span<const int> indices) {
  constexpr double kShare = 1e-12;
  double largest = 0.0;
  for (const int i : indices) {
    largest = std::max(largest, LargestNumber(pairs[static_cast<std::size_t>(i)]));
  }
  return kShare * largest;
}

// Indices of the pairs, those of one board and view next to each other.
template <class Pair>
std::vector<int> ByBoard(std::span<const Pair> pairs, std::span<const int> indices) {
  std::vector<int> order(indices.begin(), indices.end());
  const auto key = [&](int i) {
    const PairId& id = pairs[static_cast<std::size_t>(i)].id;
    return std::tuple(id.view, id.board, i);
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  return order;
}

bool IsSameBoard(const PairId& a, const PairId& b) {
  return a.view == b.view && a.board == b.board;
}

/// The sums of the header over the pairs of an answer.
struct BoardSums {
  Matrix6d information = Matrix6d::Zero();  // H
  Matrix6d by_board = Matrix6d::Zero();     // B
  Matrix6d by_mean = Matrix6d::Zero();      // sum_g S_g^T S_g / n_g
  double squares = 0.0;                     // sum |r|^2
  double between = 0.0;                     // sum_g n_g |mean r_g|^2
  double residuals = 0.0;                   // Count of numbers.
  int boards = 0;
  bool has_names = false;  // False where nothing states which pairs are of one board.
};

// None where a point does not project.
template <int kResiduals, class Pair>
std::optional<BoardSums> SumByBoard(std::span<const Pair> pairs, std::span<const int> indices,
                                    const Camera* camera, const Estimate& estimate,
                                    bool with_rotation) {
  const Eigen::Matrix3d r = estimate.cam_from_lidar.rotation.toRotationMatrix();
  const Eigen::Vector3d& t = estimate.cam_from_lidar.translation;
  const std::vector<int> order = ByBoard(pairs, indices);
  const auto id = [&](std::size_t k) { return pairs[static_cast<std::size_t>(order[k])].id; };
  BoardSums sums;
  sums.residuals = kResiduals * static_cast<double>(order.size());
  TermDerivatives<kResiduals> at;
  for (std::size_t k = 0; k < order.size();) {
    Eigen::Matrix<double, kResiduals, 6> slope = Eigen::Matrix<double, kResiduals, 6>::Zero();
    Eigen::Matrix<double, kResiduals, 1> residual = Eigen::Matrix<double, kResiduals, 1>::Zero();
    const std::size_t begin = k;
    for (; k < order.size() && IsSameBoard(id(k), id(begin)); ++k) {
      const auto term = UnitTerm(pairs[static_cast<std::size_t>(order[k])]);
      if (!Differentiate(term, camera, r, t, at)) return std::nullopt;
      Eigen::Matrix<double, kResiduals, 6> jacobian = at.Jacobian();
      if (!with_rotation) jacobian.template leftCols<3>().setZero();
      sums.information.noalias() += jacobian.transpose() * jacobian;
      sums.squares += at.residual.squaredNorm();
      slope += jacobian;
      residual += at.residual;
      sums.has_names = sums.has_names || !(id(k) == id(0));
    }
    const auto count = static_cast<double>(k - begin);
    const Matrix6d product = slope.transpose() * slope;
    sums.by_board += product;
    sums.by_mean += product / count;
    sums.between += residual.squaredNorm() / count;
    ++sums.boards;
  }
  if (!with_rotation) sums.information.diagonal().head<3>().setOnes();
  return sums;
}

/// The variances of the header, and what follows from them.
struct Components {
  double independent = 0.0;  // s_e^2
  double shared = 0.0;       // s_b^2
  double freedom = 0.0;
};

// Expects as many boards as pairs, or more than kMaxTooFewBoards.
Components Separate(const BoardSums& sums, const Matrix6d& inverse, int dimension, int unknowns,
                    bool boards_known) {
  const double within_freedom = sums.residuals - unknowns;
  Components result{sums.squares / within_freedom, 0.0, within_freedom};
  if (!boards_known) return result;
  const Matrix6d board = inverse * sums.by_board;
  const Matrix6d mean = inverse * sums.by_mean;
  // Expected values: squares = a s_e^2 + b s_b^2, between = c s_e^2 + d s_b^2.
  const double a = within_freedom;
  const double b = sums.residuals - board.trace();
  const double c = dimension * sums.boards - mean.trace();
  const double d = sums.residuals - 2.0 * board.trace() + (board * mean).trace();
  const double determinant = a * d - b * c;
  if (!(c > 0.0) || !(determinant > 1e-9 * a * d)) return result;
  result.independent = (d * sums.squares - b * sums.between) / determinant;
  result.shared = (a * sums.between - c * sums.squares) / determinant;
  if (result.shared <= 0.0) {
    result = {sums.squares / a, 0.0, within_freedom};
  } else if (result.independent < 0.0) {
    result = {0.0, sums.squares / b, within_freedom};
  }
  // The mean variance of a direction is s_e^2 + weight s_b^2.
  const double weight = board.trace() / unknowns;
  const double pairs_per_board = sums.residuals / (dimension * sums.boards);
  const double of_means = result.shared + result.independent / pairs_per_board;
  const double rest = 1.0 - std::min(1.0, weight / pairs_per_board);
  const double total = result.independent + weight * result.shared;
  const double scatter = weight * weight * of_means * of_means / c +
                         rest * rest * result.independent * result.independent / (a - c);
  if (scatter > 0.0) result.freedom = std::clamp(total * total / scatter, std::min(c, a), a);
  return result;
}

// The covariance of the header: V_0 = F F^T, M = F^-1 V F^-T.
Matrix6d Correlated(const Matrix6d& covariance, const Matrix6d& independent,
                    const Matrix6d& correlated) {
  const Eigen::LLT<Matrix6d> factor(independent);
  if (factor.info() != Eigen::Success) return covariance;
  const Matrix6d f = factor.matrixL();
  const Matrix6d inverse = factor.matrixL().solve(Matrix6d::Identity().eval());
  const SymmetricEigen<6> m = EigenOf<6>(inverse * correlated * inverse.transpose());
  const Matrix6d root =
      m.vectors * m.values.cwiseMax(0.0).cwiseSqrt().asDiagonal() * m.vectors.transpose();
  const Matrix6d turn = f * root * inverse;
  const Matrix6d result = turn * covariance * turn.transpose();
  return 0.5 * (result + result.transpose());
}

// By what to multiply the covariance of a pose, of which the variance of the noise was estimated
// with so many degrees of freedom, so that the 95 percent region of a Gaussian is that of the
// answer: 6 F(6, freedom) / chi2(6), quantiles at 0.95, to 9 percent from 2 degrees of freedom and
// to 5 percent from 4 on.
double CovarianceInflation(double freedom) {
  constexpr double kMinFreedom = 2.0;
  const double f = std::max(kMinFreedom, freedom);
  return (f + 3.0) / (f - 1.5);
}

void AddWarning(std::string warning, Estimate& estimate) {
  std::vector<std::string>& all = estimate.warnings;
  if (std::find(all.begin(), all.end(), warning) == all.end()) all.push_back(std::move(warning));
}

// `sigma` is the member of the noise for this kind of pairs.
template <int kResiduals, class Pair>
void Complete(std::span<const Pair> pairs, const Camera* camera, const SolverSpec& spec,
              std::optional<double> NoiseEstimate::*sigma, Estimate& estimate) {
  const int unknowns = spec.estimates_rotation ? 6 : 3;
  const std::optional<BoardSums> sums =
      SumByBoard<kResiduals>(pairs, estimate.inliers, camera, estimate, spec.estimates_rotation);
  if (!sums || !(sums->residuals > unknowns)) return;
  const std::optional<Matrix6d> inverse = InvertSymmetric(sums->information);
  if (!inverse || !std::isfinite(sums->squares)) return;
  NoiseEstimate noise = estimate.noise.value_or(NoiseEstimate{});
  const bool grouped = sums->has_names && sums->boards < static_cast<int>(estimate.inliers.size());
  const bool is_estimable = grouped && sums->boards > kMaxTooFewBoards;
  const Components parts = Separate(*sums, *inverse, kResiduals, unknowns, is_estimable);
  if (!(noise.*sigma)) noise.*sigma = std::sqrt(parts.independent + parts.shared);
  // A sigma of zero would state that the answer is without error.
  const double rounding = RoundingOf(pairs, estimate.inliers);
  const bool is_exact = *(noise.*sigma) <= rounding;
  if (is_exact) noise.*sigma = rounding;
  noise.boards = grouped ? sums->boards : 0;
  noise.board_errors = is_estimable ? BoardErrors::kEstimated
                       : grouped    ? BoardErrors::kTooFewBoards
                                    : BoardErrors::kAssumedIndependent;
  noise.shared_sigma = is_exact ? 0.0 : std::sqrt(parts.shared);
  noise.freedom = parts.freedom;
  estimate.noise = noise;
  if (is_exact) {
    AddWarning(
        "the pairs agree to the last digit, as measurements never do: their noise is not known, "
        "and the sigmas are of rounding alone",
        estimate);
    if (estimate.covariance && spec.estimates_rotation) {
      estimate.covariance = rounding * rounding * *inverse;
    }
    return;
  }
  if (!estimate.covariance) return;
  if (parts.shared > 0.0) {
    const double variance = sums->squares / (sums->residuals - unknowns);
    const Matrix6d correlated =
        parts.independent * *inverse + parts.shared * *inverse * sums->by_board * *inverse;
    estimate.covariance = Correlated(*estimate.covariance, variance * *inverse, correlated);
  }
  if (is_estimable) *estimate.covariance *= CovarianceInflation(parts.freedom);
  constexpr double kFewFreedom = 6.0;
  if (!grouped && parts.freedom <= kFewFreedom) {
    AddWarning(
        fmt::format("the noise is estimated from {:.0f} redundant numbers only: the region that "
                    "holds the truth with 95 percent is {:.1f} times as wide as these sigmas "
                    "make it; more pairs narrow it",
                    parts.freedom, std::sqrt(CovarianceInflation(parts.freedom))),
        estimate);
  }
  if (grouped && !is_estimable) {
    AddWarning(fmt::format("the pairs are of {} board{}, too few to estimate the error that the "
                           "pairs of a board share; the sigmas assume none and may be several "
                           "times too small",
                           sums->boards, sums->boards == 1 ? "" : "s"),
               estimate);
  }
}

}  // namespace

std::string_view ToString(BoardErrors errors) {
  switch (errors) {
    case BoardErrors::kAssumedIndependent:
      return "assumed_independent";
    case BoardErrors::kTooFewBoards:
      return "too_few_boards";
    case BoardErrors::kEstimated:
      return "estimated";
  }
  return "unknown";
}

void CompleteNoise(const CalibrationProblem& problem, const SolverSpec& spec, Estimate& estimate) {
  if (estimate.inliers.empty()) return;
  if (estimate.noise && (estimate.noise->is_given || estimate.noise->freedom > 0.0)) return;
  if (spec.needs.pairs_3d3d > 0) {
    if (HasKnownNoise(problem.pairs_3d3d.front())) return;
    Complete<3, Pair3d3d>(problem.pairs_3d3d, nullptr, spec, &NoiseEstimate::sigma_m, estimate);
  } else if (spec.needs.pairs_2d3d > 0) {
    if (HasKnownNoise(problem.pairs_2d3d.front())) return;
    const Camera& camera = estimate.camera ? estimate.camera->camera : *problem.camera;
    Complete<2, Pair2d3d>(problem.pairs_2d3d, &camera, spec, &NoiseEstimate::sigma_px, estimate);
  }
}

}  // namespace sextant
