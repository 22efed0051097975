// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_information.h"

#include <algorithm>
#include <cmath>

#include "geometry/symmetric.h"

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

// Every row has columns of at most one view, after its shared ones.
Normal NormalOf(const JointLinearisation& at) {
  Normal normal{DynamicMatrix::Zero(at.shared, at.shared), std::vector<ViewNormal>(at.views)};
  for (ViewNormal& view : normal.views) view.mixed.setZero(kViewColumns, at.shared);
  const ceres::CRSMatrix& m = at.derivative;
  for (int row = 0; row < m.num_rows; ++row) {
    const auto from = static_cast<std::size_t>(m.rows[static_cast<std::size_t>(row)]);
    const auto to = static_cast<std::size_t>(m.rows[static_cast<std::size_t>(row) + 1]);
    for (std::size_t a = from; a < to; ++a) {
      if (m.values[a] == 0.0) continue;
      const int i = m.cols[a] - at.shared;
      ViewNormal* view =
          i < 0 ? nullptr : &normal.views[static_cast<std::size_t>(i / kViewColumns)];
      for (std::size_t b = from; b < to; ++b) {
        const int j = m.cols[b] - at.shared;
        const double product = m.values[a] * m.values[b];
        if (view == nullptr) {
          if (j < 0) normal.shared(m.cols[a], m.cols[b]) += product;
        } else if (j < 0) {
          view->mixed(i % kViewColumns, m.cols[b]) += product;
        } else {
          view->own(i % kViewColumns, j % kViewColumns) += product;
        }
      }
    }
  }
  return normal;
}

// Pseudo-inverse after scaling to a unit diagonal.
DynamicMatrix InverseOf(const DynamicMatrix& information) {
  constexpr double kSmallestEigenvalue = 1e-14;
  const Eigen::VectorXd scale =
      information.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; });
  const auto eigen = EigenOf<Eigen::Dynamic>(scale.asDiagonal() * information * scale.asDiagonal());
  const Eigen::VectorXd inverse =
      eigen.values.unaryExpr([](double e) { return e > kSmallestEigenvalue ? 1.0 / e : 0.0; });
  const DynamicMatrix vectors = scale.asDiagonal() * eigen.vectors;
  return vectors * inverse.asDiagonal() * vectors.transpose();
}

/// A row of the derivative by the shared numbers and the 12 of its view.
Eigen::VectorXd RowOf(const JointLinearisation& at, std::size_t view, int row) {
  Eigen::VectorXd dense = Eigen::VectorXd::Zero(at.shared + kViewColumns);
  const ceres::CRSMatrix& m = at.derivative;
  const int skipped = kViewColumns * static_cast<int>(view);
  for (int k = m.rows[static_cast<std::size_t>(row)]; k < m.rows[static_cast<std::size_t>(row) + 1];
       ++k) {
    const int column = m.cols[static_cast<std::size_t>(k)];
    dense[column < at.shared ? column : column - skipped] = m.values[static_cast<std::size_t>(k)];
  }
  return dense;
}

double LeverageOf(const JointLinearisation& at, std::size_t view, int row,
                  const DynamicMatrix& covariance) {
  const ceres::CRSMatrix& m = at.derivative;
  const int skipped = kViewColumns * static_cast<int>(view);
  const auto from = static_cast<std::size_t>(m.rows[static_cast<std::size_t>(row)]);
  const auto to = static_cast<std::size_t>(m.rows[static_cast<std::size_t>(row) + 1]);
  const auto place = [&](std::size_t k) {
    return m.cols[k] < at.shared ? m.cols[k] : m.cols[k] - skipped;
  };
  double leverage = 0.0;
  for (std::size_t a = from; a < to; ++a) {
    if (m.values[a] == 0.0) continue;
    for (std::size_t b = from; b < to; ++b) {
      leverage += m.values[a] * m.values[b] * covariance(place(a), place(b));
    }
  }
  return leverage;
}

bool IsZero(const JointLinearisation& at, int row) {
  const ceres::CRSMatrix& m = at.derivative;
  for (int k = m.rows[static_cast<std::size_t>(row)]; k < m.rows[static_cast<std::size_t>(row) + 1];
       ++k) {
    if (m.values[static_cast<std::size_t>(k)] != 0.0) return false;
  }
  return true;
}

KindSum SumOf(const JointLinearisation& at, const JointRows& rows,
              const DynamicMatrix& covariance) {
  KindSum sum;
  for (int row = rows.first; row < rows.first + rows.count; ++row) {
    if (IsZero(at, row)) continue;
    const double residual = at.residuals[static_cast<std::size_t>(row)];
    sum.squares += residual * residual;
    sum.redundancy += 1.0 - LeverageOf(at, rows.view, row, covariance);
  }
  return sum;
}

void AddLink(const JointLinearisation& at, const JointRows& rows, const DynamicMatrix& covariance,
             ViewSums& sums) {
  if (IsZero(at, rows.first)) return;
  Eigen::MatrixXd by(at.shared + kViewColumns, 6);
  Vector6d residual;
  for (int i = 0; i < 6; ++i) {
    by.col(i) = RowOf(at, rows.view, rows.first + i);
    residual[i] = at.residuals[static_cast<std::size_t>(rows.first + i)];
  }
  // The covariance of the residuals of a least squares fit.
  const Matrix6d spread = Matrix6d::Identity() - by.transpose() * covariance * by;
  for (int i = 0; i < 6; ++i) {
    KindSum& sum = kLinkIsOutOfPlane[i] ? sums.out_of_plane : sums.in_plane;
    sum += {residual[i] * residual[i], std::max(0.0, spread(i, i))};
  }
  constexpr double kSmallest = 1e-7;
  const SymmetricEigen<6> eigen = EigenOf<6>(spread);
  for (int i = 0; i < 6; ++i) {
    if (eigen.values[i] < kSmallest) continue;
    const double along = eigen.vectors.col(i).dot(residual);
    sums.contradiction += along * along / eigen.values[i];
    ++sums.freedom;
  }
}

}  // namespace

std::optional<JointCovariance> JointCovariance::Of(const JointLinearisation& at) {
  const Normal normal = NormalOf(at);
  JointCovariance covariance;
  DynamicMatrix information = normal.shared;
  for (const ViewNormal& view : normal.views) {
    covariance.views_.push_back(InverseOf(view.own));
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

}  // namespace sextant
