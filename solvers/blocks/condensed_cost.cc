// SPDX-License-Identifier: Apache-2.0
#include "solvers/blocks/condensed_cost.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace sextant {
namespace {

using AnyRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using CondensedRows = Eigen::Map<AnyRows>;

// The upper triangle of A^T A.
AnyRows NormalOf(const AnyRows& a) {
  AnyRows normal = AnyRows::Zero(a.cols(), a.cols());
  for (Eigen::Index row = 0; row < a.rows(); ++row) {
    for (Eigen::Index i = 0; i < a.cols(); ++i) {
      const double factor = a(row, i);
      for (Eigen::Index k = i; k < a.cols(); ++k) normal(i, k) += factor * a(row, k);
    }
  }
  return normal;
}

// From the upper triangle of a positive semidefinite N to R with R^T R = N, above the diagonal too.
// A direction of which N knows nothing but rounding has a row of zeros: the least squares that
// follow form N themselves, so that nothing is lost.
void FactoriseInPlace(AnyRows& normal) {
  constexpr double kRounding = 1e-15;
  const Eigen::Index size = normal.rows();
  for (Eigen::Index i = 0; i < size; ++i) normal.row(i).head(i).setZero();
  const Eigen::VectorXd least = kRounding * static_cast<double>(size) * normal.diagonal();
  for (Eigen::Index i = 0; i < size; ++i) {
    auto row = normal.row(i).tail(size - i);
    if (!(row[0] > least[i])) {
      row.setZero();
      continue;
    }
    row /= std::sqrt(row[0]);
    for (Eigen::Index k = i + 1; k < size; ++k) {
      normal.row(k).tail(size - k) -= normal(i, k) * normal.row(i).tail(size - k);
    }
  }
}

}  // namespace

CondensedCost::CondensedCost(std::unique_ptr<ceres::CostFunction> all, int first, int count)
    : all_(std::move(all)), first_(first), count_(count) {
  *mutable_parameter_block_sizes() = all_->parameter_block_sizes();
  columns_ = count;
  for (std::size_t b = 1; b < parameter_block_sizes().size(); ++b) {
    columns_ += parameter_block_sizes()[b];
  }
  set_num_residuals(std::min(all_->num_residuals(), columns_ + 1));
}

bool CondensedCost::Evaluate(double const* const* parameters, double* residuals,
                             double** jacobians) const {
  if (num_residuals() == all_->num_residuals()) {
    return all_->Evaluate(parameters, residuals, jacobians);
  }
  if (jacobians != nullptr) return Condense(parameters, residuals, jacobians);
  Eigen::VectorXd values(all_->num_residuals());
  if (!all_->Evaluate(parameters, values.data(), nullptr)) return false;
  Eigen::Map<Eigen::VectorXd> condensed(residuals, num_residuals());
  condensed.setZero();
  condensed[0] = values.norm();
  return true;
}

bool CondensedCost::Condense(double const* const* parameters, double* residuals,
                             double** jacobians) const {
  const Eigen::Index rows = all_->num_residuals();
  const std::vector<int>& sizes = parameter_block_sizes();
  Eigen::VectorXd values(rows);
  std::vector<AnyRows> derivatives(sizes.size());
  std::vector<double*> places(sizes.size(), nullptr);
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    if (jacobians[b] == nullptr) continue;
    derivatives[b].resize(rows, sizes[b]);
    places[b] = derivatives[b].data();
  }
  if (!all_->Evaluate(parameters, values.data(), places.data())) return false;
  AnyRows joined = AnyRows::Zero(rows, columns_ + 1);
  Eigen::Index at = 0;
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    const Eigen::Index width = b == 0 ? count_ : sizes[b];
    if (places[b] != nullptr) {
      joined.middleCols(at, width) = derivatives[b].middleCols(b == 0 ? first_ : 0, width);
    }
    at += width;
  }
  joined.col(at) = values;
  AnyRows triangle = NormalOf(joined);
  FactoriseInPlace(triangle);
  at = 0;
  for (std::size_t b = 0; b < sizes.size(); ++b) {
    const Eigen::Index width = b == 0 ? count_ : sizes[b];
    if (jacobians[b] != nullptr) {
      CondensedRows to(jacobians[b], num_residuals(), sizes[b]);
      to.setZero();
      to.middleCols(b == 0 ? first_ : 0, width) = triangle.middleCols(at, width);
    }
    at += width;
  }
  Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) = triangle.col(at);
  return true;
}

}  // namespace sextant
