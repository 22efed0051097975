// SPDX-License-Identifier: Apache-2.0
#include "solvers/icp/ring_offsets.h"

#include <algorithm>
#include <cmath>

#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr std::size_t kMinWindows = 10;  ///< Per row.
constexpr std::size_t kMinRows = 4;
constexpr double kMaxOfRow = 4.0;  ///< Maximum variance of a row, relative to the lower quartile.
constexpr double kMaxOfWindow =
    2.0;  ///< Maximum variance of a window, relative to that of its row.
constexpr double kWindowsOfACell = 9.0;
constexpr double kSameSlope =
    0.25;  ///< In cell heights: below, rows of two scans are the same ring.
constexpr double kMinStiffness = 2e-3;  ///< Relative: below, planes absorb an offset.
constexpr double kMinSigma_m = 0.0005;
constexpr double kMaxSigma_m = 0.05;
constexpr double kNextSigma = 1.3;
constexpr double kMinEvidence = 20.0;      ///< Twice the logarithm of the likelihoods' ratio.
constexpr double kMaxContradiction = 0.1;  ///< Share of what separate offsets explain.

using Eigen::Index;

// Normal equations of the offsets of some rings.
struct Equations {
  explicit Equations(Index rings)
      : normal(Eigen::MatrixXd::Zero(rings, rings)), right(Eigen::VectorXd::Zero(rings)) {}

  Eigen::MatrixXd normal;
  Eigen::VectorXd right;
};

// Sums over the three cells of a row of a window.
struct RowOfWindow {
  double count = 0.0;
  double nearness = 0.0;  ///< Reciprocal of the RMS range.
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
};

RowOfWindow SumRow(const ScanCells& cells, int row, int column) {
  RowOfWindow sums;
  double squares = 0.0;
  for (int c = -1; c <= 1; ++c) {
    const int other = (column + c + cells.columns()) % cells.columns();
    const auto& of = cells.sums()[static_cast<std::size_t>(row * cells.columns() + other)].of;
    const double* first = of.data() + CellSums::kFirst;
    const double* second = of.data() + CellSums::kSecond;
    sums.count += of[CellSums::kCount];
    sums.sum += Eigen::Vector3d(first[0], first[1], first[2]);
    squares += second[0] + second[3] + second[5];
  }
  if (squares > 0.0) sums.nearness = std::sqrt(sums.count / squares);
  return sums;
}

// Contribution of the window around (row, column) to the normal equations of the offsets of its
// three rows.
struct WindowShare {
  Eigen::Matrix3d normal;
  Eigen::Vector3d right;
};

WindowShare ShareOf(const ScanWindows& windows, int row, int column, double variance) {
  const auto cell = static_cast<std::size_t>(row * windows.cells().columns() + column);
  const auto& inverse = windows.planes().inverse;
  const auto at = [&](std::size_t k) { return inverse[k][cell]; };
  Eigen::Matrix3d inverse_moments;
  inverse_moments << at(0), at(1), at(2), at(1), at(3), at(4), at(2), at(4), at(5);
  Eigen::Matrix3d sums;
  Eigen::Vector3d counts;
  Eigen::Vector3d all = Eigen::Vector3d::Zero();
  Eigen::Vector3d nearness;
  for (int r = 0; r < 3; ++r) {
    const RowOfWindow of_row = SumRow(windows.cells(), row + r - 1, column);
    all += of_row.sum;
    nearness[r] = of_row.nearness;
    sums.col(r) = of_row.nearness * of_row.sum;
    counts[r] = of_row.nearness * of_row.count;
  }
  // Noise in the points biases the least-squares m towards zero, which would shift all ranges:
  // rescaled.
  const Eigen::Vector3d fitted = inverse_moments * all;
  const double count = counts.cwiseQuotient(nearness.cwiseMax(1e-12)).sum();
  const Eigen::Vector3d m = count / fitted.dot(all) * fitted;
  const Eigen::Vector3d squares = counts.cwiseProduct(nearness);
  const double weight = count / (squares.sum() * variance * kWindowsOfACell);
  const Eigen::Matrix3d own = squares.asDiagonal();
  return {.normal = weight * (own - sums.transpose() * inverse_moments * sums),
          .right = weight * (sums.transpose() * m - counts)};
}

// Windows are compared with the noise quantile of their own row, as its offset must not make them
// look rough.
Equations EquationsOf(const ScanWindows& windows, std::span<const Index> ring_of_row, Index rings) {
  const int rows = windows.cells().rows();
  const auto columns = static_cast<std::size_t>(windows.cells().columns());
  std::vector<double> of_row;
  std::vector<double> variances;
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row) {
    of_row.push_back(windows.NoiseVariance(row * columns, columns, kMinWindows));
    if (of_row.back() > 0.0) variances.push_back(of_row.back());
  }
  Equations equations(rings);
  if (variances.size() < kMinRows) return equations;
  const auto quartile = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 4);
  std::nth_element(variances.begin(), quartile, variances.end());
  for (int row = 1; row + 1 < rows; ++row) {
    const auto r = static_cast<std::size_t>(row);
    if (of_row[r] > kMaxOfRow * *quartile) continue;
    for (std::size_t column = 0; column < columns; ++column) {
      const std::size_t cell = r * columns + column;
      const bool is_flat = windows.CanEstimateNoise(cell) &&
                           windows.planes().range_variance[cell] < kMaxOfWindow * of_row[r];
      if (!is_flat) continue;
      const WindowShare share = ShareOf(windows, row, static_cast<int>(column), *quartile);
      for (int a = 0; a < 3; ++a) {
        const Index ring = ring_of_row[r + static_cast<std::size_t>(a) - 1];
        equations.right[ring] += share.right[a];
        for (int b = 0; b < 3; ++b) {
          equations.normal(ring, ring_of_row[r + static_cast<std::size_t>(b) - 1]) +=
              share.normal(a, b);
        }
      }
    }
  }
  return equations;
}

// The equations diagonalised by eigenvectors, without the directions that planes absorb.
struct Modes {
  explicit Modes(const Equations& equations) {
    const SymmetricEigen<Eigen::Dynamic> eigen = EigenOf(equations.normal);
    const Eigen::VectorXd& stiffness = eigen.values;
    const double least = kMinStiffness * stiffness[stiffness.size() - 1];
    Index first = 0;
    while (first < stiffness.size() && !(stiffness[first] > least)) ++first;
    const Index count = stiffness.size() - first;
    directions = eigen.vectors.rightCols(count);
    stiffnesses = stiffness.tail(count);
    right = directions.transpose() * equations.right;
  }

  // Twice the log likelihood ratio of offsets with this sigma against none.
  double Evidence(double sigma_m) const {
    const Eigen::ArrayXd gain = stiffnesses.array() * (sigma_m * sigma_m);
    return (right.array().square() / stiffnesses.array() * gain / (1.0 + gain) - gain.log1p())
        .sum();
  }

  // Zero where there is no evidence.
  Eigen::VectorXd Offsets() const {
    double likeliest_m = 0.0;
    double most = kMinEvidence;
    for (double sigma_m = kMinSigma_m; sigma_m < kMaxSigma_m; sigma_m *= kNextSigma) {
      const double evidence = Evidence(sigma_m);
      if (evidence <= most) continue;
      most = evidence;
      likeliest_m = sigma_m;
    }
    if (likeliest_m == 0.0) return Eigen::VectorXd::Zero(directions.rows());
    const Eigen::ArrayXd prior = Eigen::ArrayXd::Constant(right.size(), std::pow(likeliest_m, -2));
    return directions * (right.array() / (stiffnesses.array() + prior)).matrix();
  }

  // Reduction of the sum of squared residuals by the best offsets.
  double Explained() const { return (right.array().square() / stiffnesses.array()).sum(); }

  Eigen::MatrixXd directions;
  Eigen::VectorXd stiffnesses;
  Eigen::VectorXd right;
};

// Ring indices for the rows of both scans, equal where their elevations are.
struct Rings {
  Rings(const ScanCells& target, const ScanCells& source) {
    std::vector<double> slopes;
    for (int row = 0; row < target.rows(); ++row) {
      slopes.push_back(target.SlopeOf(row));
      of_target.push_back(row);
    }
    for (int row = 0; row < source.rows(); ++row) {
      const double slope = source.SlopeOf(row);
      const auto same = std::ranges::find_if(slopes, [&](double other) {
        return std::abs(slope - other) < kSameSlope * target.cell_rad();
      });
      of_source.push_back(same - slopes.begin());
      if (same == slopes.end()) slopes.push_back(slope);
    }
    count = std::ssize(slopes);
  }

  std::vector<Index> of_target;
  std::vector<Index> of_source;
  Index count = 0;
};

std::vector<double> ByRow(const Eigen::VectorXd& of_ring, std::span<const Index> ring_of_row) {
  if (of_ring.isZero(0.0)) return {};
  std::vector<double> offsets;
  for (const Index ring : ring_of_row) offsets.push_back(of_ring[ring]);
  return offsets;
}

}  // namespace

RingOffsets EstimateRingOffsets(const ScanWindows& target, const ScanWindows& source) {
  const Rings rings(target.cells(), source.cells());
  const Equations of_target = EquationsOf(target, rings.of_target, rings.count);
  const Equations of_source = EquationsOf(source, rings.of_source, rings.count);
  Equations sum = of_target;
  sum.normal += of_source.normal;
  sum.right += of_source.right;
  if (sum.normal.isZero(0.0)) return {};
  const Modes together(sum);
  const Eigen::VectorXd shared = together.Offsets();
  const Modes target_alone(of_target);
  const Modes source_alone(of_source);
  const double apart = target_alone.Explained() + source_alone.Explained();
  if (apart - together.Explained() < kMaxContradiction * apart) {
    return {.target_m = ByRow(shared, rings.of_target), .source_m = ByRow(shared, rings.of_source)};
  }
  return {.target_m = ByRow(target_alone.Offsets(), rings.of_target),
          .source_m = ByRow(source_alone.Offsets(), rings.of_source)};
}

}  // namespace sextant
