// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/rig_information.h"

#include <algorithm>
#include <cmath>

#include "geometry/symmetric.h"
#include "solvers/blocks/scaled_inverse.h"

namespace sextant {
namespace {

/// One row, by place: shared columns, then the placement's own ones from `shared` on.
struct RowEntries {
  std::vector<int> places;
  std::vector<double> values;

  void Read(const RigLinearisation& at, int row, std::size_t placement) {
    places.clear();
    values.clear();
    const ceres::CRSMatrix& m = at.derivative;
    const auto r = static_cast<std::size_t>(row);
    const auto end = static_cast<std::size_t>(m.rows[r + 1]);
    for (auto k = static_cast<std::size_t>(m.rows[r]); k < end; ++k) {
      if (m.values[k] == 0.0) continue;
      const int column = m.cols[k];
      places.push_back(column < at.shared ? column
                                          : at.shared + column - at.first_column[placement]);
      values.push_back(m.values[k]);
    }
  }
};

/// The normal equations of one placement: its own columns and those that it shares.
struct PlacementNormal {
  Eigen::MatrixXd
      inverse;            ///< The inverse of its own part; 0 along directions without information.
  Eigen::MatrixXd slope;  ///< Change of its minimum by the shared columns.
};

class NormalEquations {
 public:
  explicit NormalEquations(const RigLinearisation& at)
      : at_(at), shared_(Eigen::MatrixXd::Zero(at.shared, at.shared)) {
    AddPriors();
    std::size_t row = 0;
    for (std::size_t i = 0; i + 1 < at.first_column.size(); ++i) {
      const std::size_t first = row;
      while (row < at.rows.size() && at.rows[row].placement == i) ++row;
      AddPlacement(i, first, row);
    }
  }

  const Eigen::MatrixXd& shared() const { return shared_; }
  const std::vector<PlacementNormal>& placements() const { return placements_; }

 private:
  // The rows of the numbers' priors come after those of all placements.
  void AddPriors() {
    const int first = at_.rows.empty() ? 0 : at_.rows.back().first + at_.rows.back().count;
    RowEntries row;
    for (int i = first; i < at_.derivative.num_rows; ++i) {
      row.Read(at_, i, 0);
      for (std::size_t k = 0; k < row.places.size(); ++k) {
        shared_(row.places[k], row.places[k]) += row.values[k] * row.values[k];
      }
    }
  }

  void AddPlacement(std::size_t placement, std::size_t first, std::size_t end) {
    const int own = at_.first_column[placement + 1] - at_.first_column[placement];
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(own, own);
    Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(own, at_.shared);
    RowEntries row;
    for (std::size_t k = first; k < end; ++k) {
      for (int i = at_.rows[k].first; i < at_.rows[k].first + at_.rows[k].count; ++i) {
        row.Read(at_, i, placement);
        Add(row, normal, mixed);
      }
    }
    placements_.push_back({ScaledInverse(normal), {}});
    placements_.back().slope = -placements_.back().inverse * mixed;
    shared_.noalias() += mixed.transpose() * placements_.back().slope;
  }

  void Add(const RowEntries& row, Eigen::MatrixXd& normal, Eigen::MatrixXd& mixed) {
    for (std::size_t a = 0; a < row.places.size(); ++a) {
      const int own = row.places[a] - at_.shared;
      for (std::size_t b = 0; b < row.places.size(); ++b) {
        const double product = row.values[a] * row.values[b];
        const int other = row.places[b] - at_.shared;
        if (own < 0 && other < 0) shared_(row.places[a], row.places[b]) += product;
        if (own >= 0 && other < 0) mixed(own, row.places[b]) += product;
        if (own >= 0 && other >= 0) normal(own, other) += product;
      }
    }
  }

  const RigLinearisation& at_;
  Eigen::MatrixXd shared_;
  std::vector<PlacementNormal> placements_;
};

// The covariance of the shared columns and a placement's own ones.
Eigen::MatrixXd WithOwn(const Eigen::MatrixXd& shared, const PlacementNormal& normal) {
  const Eigen::Index s = shared.rows();
  const Eigen::Index own = normal.inverse.rows();
  const Eigen::MatrixXd mixed = normal.slope * shared;
  Eigen::MatrixXd all(s + own, s + own);
  all.topLeftCorner(s, s) = shared;
  all.bottomLeftCorner(own, s) = mixed;
  all.topRightCorner(s, own) = mixed.transpose();
  all.bottomRightCorner(own, own) = normal.inverse + mixed * normal.slope.transpose();
  return all;
}

double LeverageOf(const RowEntries& row, const Eigen::MatrixXd& covariance) {
  double leverage = 0.0;
  for (std::size_t a = 0; a < row.places.size(); ++a) {
    for (std::size_t b = 0; b < row.places.size(); ++b) {
      leverage += row.values[a] * row.values[b] * covariance(row.places[a], row.places[b]);
    }
  }
  return leverage;
}

}  // namespace

std::optional<RigInformation> RigInformationOf(const RigLinearisation& at) {
  const NormalEquations normal(at);
  const Eigen::MatrixXd symmetric = 0.5 * (normal.shared() + normal.shared().transpose());
  auto inverse = InvertSymmetric<Eigen::Dynamic>(symmetric);
  if (!inverse) return std::nullopt;
  RigInformation information{*inverse, std::vector<RigSum>(at.rows.size()),
                             std::vector<RigSum>(at.rows.size())};
  Eigen::MatrixXd covariance;
  RowEntries row;
  for (std::size_t k = 0; k < at.rows.size(); ++k) {
    const RigRows& rows = at.rows[k];
    if (k == 0 || at.rows[k - 1].placement != rows.placement) {
      covariance = WithOwn(*inverse, normal.placements()[rows.placement]);
    }
    for (int i = 0; i < rows.count; ++i) {
      row.Read(at, rows.first + i, rows.placement);
      if (row.values.empty()) continue;
      const bool in_plane = rows.block < 0 && !kShiftIsOutOfPlane[static_cast<std::size_t>(i)];
      RigSum& sum = in_plane ? information.in_plane[k] : information.sums[k];
      const double residual = at.residuals[static_cast<std::size_t>(rows.first + i)];
      sum.squares += residual * residual;
      sum.redundancy += std::max(0.0, 1.0 - LeverageOf(row, covariance));
    }
  }
  return information;
}

}  // namespace sextant
