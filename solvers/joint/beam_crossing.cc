// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/beam_crossing.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace sextant {
namespace {

double Slope(const Eigen::Vector3d& direction) {
  return direction.z() / std::max(direction.head<2>().norm(), 1e-9);
}

}  // namespace

bool BeamsStartAtOrigin(const CalibrationProblem& problem) {
  constexpr double kSame = 2e-4;
  struct Interval {
    double low = INFINITY;
    double high = -INFINITY;
  };
  std::map<int, Interval> slopes;
  for (const BoardView& view : problem.board_views) {
    if (view.face_rings.size() != view.face_in_lidar.size()) return false;
    for (std::size_t k = 0; k < view.face_rings.size(); ++k) {
      const double slope = Slope(view.face_in_lidar[k]);
      Interval& of_ring = slopes[view.face_rings[k]];
      of_ring.low = std::min(of_ring.low, slope);
      of_ring.high = std::max(of_ring.high, slope);
    }
  }
  return slopes.size() > 1 && std::ranges::all_of(slopes, [](const auto& ring) {
           return ring.second.high - ring.second.low < kSame;
         });
}

Eigen::VectorXd RangeByCrossing(const BoardViewTerms& terms, const BoardPlane& plane) {
  const Eigen::Vector3d normal = plane.axes.col(2);
  Eigen::VectorXd by(std::ssize(terms.face));
  for (Eigen::Index k = 0; k < by.size(); ++k) {
    const Eigen::Vector3d& ray = terms.face[static_cast<std::size_t>(k)].direction;
    by[k] = Slope(ray) * normal.z() / normal.dot(ray);
  }
  return by;
}

Eigen::VectorXd OutwardByCrossing(const BoardViewTerms& terms, const BoardPlane& plane) {
  const Eigen::Vector3d normal = plane.axes.col(2);
  Eigen::VectorXd by(std::ssize(terms.edges));
  for (Eigen::Index k = 0; k < by.size(); ++k) {
    const EdgeTerm& edge = terms.edges[static_cast<std::size_t>(k)];
    const Eigen::Vector3d outward = plane.axes.leftCols<2>() * edge.side.outward;
    const Eigen::Vector3d moved =
        Eigen::Vector3d::UnitZ() - edge.direction * (normal.z() / normal.dot(edge.direction));
    by[k] = Slope(edge.direction) * outward.dot(moved);
  }
  return by;
}

}  // namespace sextant
