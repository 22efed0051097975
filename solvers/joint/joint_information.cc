// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_information.h"

#include <algorithm>
#include <cmath>

#include "geometry/symmetric.h"
#include "solvers/blocks/scaled_inverse.h"

namespace sextant {
namespace {

using DynamicMatrix = Eigen::MatrixXd;

constexpr int kViewColumns = 12;

struct ViewNormal {
  Matrix12d own = Matrix12d::Zero();
  Eigen::Matrix<double, kViewColumns, Eigen::Dynamic> mixed;
};

struct Normal {
  DynamicMatrix shared;
  std::vector<ViewNormal> views;
};

/// The numbers of one row that are not 0, by their place among the shared columns and, after those,
/// the 12 of its view.
struct SparseRow {
  std::vector<int> places;
  std::vector<double> values;
  int view = -1;  ///< None for priors.

  void Read(const JointLinearisation& at, int row) {
    const ceres::CRSMatrix& m = at.derivative;
    places.clear();
    values.clear();
    view = -1;
    const auto r = static_cast<std::size_t>(row);
    for (auto k = static_cast<std::size_t>(m.rows[r]); k < static_cast<std::size_t>(m.rows[r + 1]);
         ++k) {
      if (m.values[k] == 0.0) continue;
      const int own = m.cols[k] - at.shared;
      if (own >= 0) view = own / kViewColumns;
      places.push_back(own < 0 ? m.cols[k] : at.shared + own % kViewColumns);
      values.push_back(m.values[k]);
    }
  }
};

// Every row has columns of at most one view, after its shared ones.
Normal NormalOf(const JointLinearisation& at) {
  Normal normal{DynamicMatrix::Zero(at.shared, at.shared), std::vector<ViewNormal>(at.views)};
  for (ViewNormal& view : normal.views) view.mixed.setZero(kViewColumns, at.shared);
  SparseRow row;
  for (int i = 0; i < at.derivative.num_rows; ++i) {
    row.Read(at, i);
    ViewNormal* view = row.view < 0 ? nullptr : &normal.views[static_cast<std::size_t>(row.view)];
    for (std::size_t a = 0; a < row.places.size(); ++a) {
      const int own = row.places[a] - at.shared;
      for (std::size_t b = 0; b < row.places.size(); ++b) {
        const double product = row.values[a] * row.values[b];
        const int other = row.places[b] - at.shared;
        if (own < 0 && other < 0) normal.shared(row.places[a], row.places[b]) += product;
        if (own >= 0 && other < 0) view->mixed(own, row.places[b]) += product;
        if (own >= 0 && other >= 0) view->own(own, other) += product;
      }
    }
  }
  return normal;
}

double LeverageOf(const SparseRow& row, const DynamicMatrix& covariance) {
  double leverage = 0.0;
  for (std::size_t a = 0; a < row.places.size(); ++a) {
    double sum = 0.5 * row.values[a] * covariance(row.places[a], row.places[a]);
    for (std::size_t b = 0; b < a; ++b) {
      sum += row.values[b] * covariance(row.places[b], row.places[a]);
    }
    leverage += 2.0 * row.values[a] * sum;
  }
  return leverage;
}

KindSum SumOf(const JointLinearisation& at, const JointRows& rows,
              const DynamicMatrix& covariance) {
  KindSum sum{.redundancy = static_cast<double>(rows.observed)};
  SparseRow row;
  for (int i = rows.first; i < rows.first + rows.count; ++i) {
    row.Read(at, i);
    const double residual = at.residuals[static_cast<std::size_t>(i)];
    sum.squares += residual * residual;
    sum.redundancy -= LeverageOf(row, covariance);
  }
  return sum;
}

void AddLink(const JointLinearisation& at, const JointRows& rows, const DynamicMatrix& covariance,
             ViewSums& sums) {
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(at.shared + kViewColumns, 6);
  Vector6d residual;
  SparseRow row;
  for (int i = 0; i < 6; ++i) {
    row.Read(at, rows.first + i);
    if (row.values.empty()) return;
    for (std::size_t k = 0; k < row.places.size(); ++k) by(row.places[k], i) = row.values[k];
    residual[i] = at.residuals[static_cast<std::size_t>(rows.first + i)];
  }
  // The covariance of the residuals of a least squares fit.
  const Matrix6d spread = Matrix6d::Identity() - by.transpose() * covariance * by;
  for (int i = 0; i < 6; ++i) {
    KindSum& sum = kLinkIsOutOfPlane[i] ? sums.out_of_plane : sums.in_plane;
    sum += {residual[i] * residual[i], std::max(0.0, spread(i, i))};
  }
  // Without this view's link, the residual is (I - H)^-1 r and its variance that of the estimate,
  // H (I - H)^-1, and of the link; H = I - spread, both of weighted rows.
  constexpr double kSmallest = 1e-7;
  const double weight = std::pow(at.link_factors[rows.view], 2);
  const SymmetricEigen<6> eigen = EigenOf<6>(spread);
  for (int i = 0; i < 6; ++i) {
    const double rest = eigen.values[i];
    if (rest < kSmallest) continue;
    const double along = eigen.vectors.col(i).dot(residual) / rest;
    sums.contradiction += along * along / (weight + std::max(0.0, 1.0 - rest) / rest);
    ++sums.freedom;
  }
}

}  // namespace

std::optional<JointCovariance> JointCovariance::Of(const JointLinearisation& at) {
  const Normal normal = NormalOf(at);
  JointCovariance covariance;
  DynamicMatrix information = normal.shared;
  for (const ViewNormal& view : normal.views) {
    covariance.views_.push_back(ScaledInverse(view.own));
    covariance.by_shared_.push_back(-covariance.views_.back() * view.mixed);
    information.noalias() += view.mixed.transpose() * covariance.by_shared_.back();
  }
  information = (0.5 * (information + information.transpose())).eval();
  const auto inverse = InvertSymmetric<Eigen::Dynamic>(information);
  if (!inverse) return std::nullopt;
  covariance.shared_ = *inverse;
  return covariance;
}

Eigen::MatrixXd JointCovariance::WithView(std::size_t view) const {
  const auto& slope = by_shared_[view];
  const Eigen::Index shared = shared_.rows();
  Eigen::MatrixXd all(shared + kViewColumns, shared + kViewColumns);
  const Eigen::MatrixXd mixed = slope * shared_;
  all.topLeftCorner(shared, shared) = shared_;
  all.bottomLeftCorner(kViewColumns, shared) = mixed;
  all.topRightCorner(shared, kViewColumns) = mixed.transpose();
  all.bottomRightCorner(kViewColumns, kViewColumns) = views_[view] + mixed * slope.transpose();
  return all;
}

std::vector<ViewSums> SumsOf(const JointLinearisation& at, const JointCovariance& covariance) {
  std::vector<ViewSums> sums(at.views);
  Eigen::MatrixXd of_view;
  std::size_t view = at.views;
  for (const JointRows& rows : at.rows) {
    if (rows.view != view) of_view = covariance.WithView(view = rows.view);
    ViewSums& to = sums[view];
    if (rows.kind == JointKind::kPrinted) to.printed += SumOf(at, rows, of_view);
    if (rows.kind == JointKind::kFace) to.face += SumOf(at, rows, of_view);
    if (rows.kind == JointKind::kEdges) to.edges += SumOf(at, rows, of_view);
    if (rows.kind == JointKind::kLink) AddLink(at, rows, of_view, to);
  }
  return sums;
}

KindSum RingSumOf(const JointModel& model, const JointState& state,
                  const JointCovariance& covariance, double ratio) {
  KindSum sum;
  Eigen::Index at = 6;
  for (std::size_t k = 0; k < model.shared.size(); ++k) {
    const SharedBlock& block = model.shared[k];
    if (block.is_ring) {
      const double variance = std::pow(ratio * block.sigma[0], 2);
      const double off = state.shared[k][0] - block.mean[0];
      sum += {off * off / variance, std::max(0.0, 1.0 - covariance.shared()(at, at) / variance)};
    }
    at += block.mean.size();
  }
  return sum;
}

}  // namespace sextant
