// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/board_bend.h"

namespace sextant {

Eigen::Matrix<double, Eigen::Dynamic, kBends> RangeByBend(const BoardViewTerms& terms,
                                                          const BoardPlane& plane,
                                                          double half_diagonal_m) {
  const Eigen::Vector3d normal = plane.axes.col(2);
  Eigen::Matrix<double, Eigen::Dynamic, kBends> by(std::ssize(terms.face), kBends);
  for (Eigen::Index k = 0; k < by.rows(); ++k) {
    const Eigen::Vector3d& ray = terms.face[static_cast<std::size_t>(k)].direction;
    const double inverse_slope = 1.0 / normal.dot(ray);
    const Eigen::Vector3d at = normal.dot(plane.origin) * inverse_slope * ray - plane.origin;
    const Eigen::Vector2d p = plane.axes.leftCols<2>().transpose() * at / half_diagonal_m;
    by.row(k) << p.x() * p.x(), p.x() * p.y(), p.y() * p.y();
    by.row(k) *= inverse_slope;
  }
  return by;
}

}  // namespace sextant
