// SPDX-License-Identifier: Apache-2.0
#include "solvers/icp/point_tree.h"

#include <nanoflann.hpp>

namespace sextant {
namespace {

struct TreePoints {
  std::span<const Eigen::Vector3d> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Distance = nanoflann::L2_Simple_Adaptor<double, TreePoints, double, unsigned>;
using Tree = nanoflann::KDTreeSingleIndexAdaptor<Distance, TreePoints, 3, unsigned>;

#if NANOFLANN_VERSION >= 0x150
using SearchParameters = nanoflann::SearchParameters;
#else
using SearchParameters = nanoflann::SearchParams;
#endif

// A result set for nanoflann that starts from an upper bound, which nanoflann's own cannot.
struct NearestWithin {
  using DistanceType = double;

  PointTree::Neighbour best;

  bool addPoint(double squared_distance, unsigned index) {
    if (squared_distance < best.squared_distance_m2) {
      best = {static_cast<int>(index), squared_distance};
    }
    return true;
  }
  double worstDist() const { return best.squared_distance_m2; }
  bool full() const { return true; }
  bool empty() const { return best.index < 0; }
  std::size_t size() const { return empty() ? 0 : 1; }
  void sort() {}  // Called by nanoflann 1.6.
};

}  // namespace

struct PointTree::Index {
  explicit Index(std::span<const Eigen::Vector3d> set)
      : points{set}, tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize)) {}

  static constexpr std::size_t kLeafSize = 10;
  TreePoints points;
  Tree tree;
};

PointTree::PointTree(std::span<const Eigen::Vector3d> points)
    : index_(std::make_unique<const Index>(points)) {}
PointTree::~PointTree() = default;

PointTree::Neighbour PointTree::Nearest(const Eigen::Vector3d& query, double closer_than_m2,
                                        int hint) const {
  NearestWithin nearest{{-1, closer_than_m2}};
  if (hint >= 0) {
    const auto i = static_cast<unsigned>(hint);
    nearest.addPoint((query - index_->points.points[i]).squaredNorm(), i);
  }
  index_->tree.findNeighbors(nearest, query.data(), SearchParameters());
  return nearest.best;
}

std::size_t PointTree::NearestFew(const Eigen::Vector3d& query, std::span<unsigned> indices,
                                  std::span<double> squared_distances_m2) const {
  return index_->tree.knnSearch(query.data(), indices.size(), indices.data(),
                                squared_distances_m2.data());
}

}  // namespace sextant
