// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

namespace sextant {

/// Nearest neighbours by a k-d tree (nanoflann). Immutable, thread-safe; a search allocates
/// nothing.
class PointTree {
 public:
  /// The points [m] must outlive the tree. O(n log n) to build, 4 bytes per point.
  explicit PointTree(std::span<const Eigen::Vector3d> points);
  ~PointTree();
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  struct Neighbour {
    int index = -1;  ///< -1 where no point is within the bound.
    double squared_distance_m2 = 0.0;
  };

  /// The nearest point closer than sqrt(closer_than_m2). `hint` is the index of a point that is
  /// likely near (-1 for none): it makes the search faster and does not change the result.
  Neighbour Nearest(const Eigen::Vector3d& query, double closer_than_m2, int hint = -1) const;

  /// Fills `indices` with the nearest points, nearest first, and returns how many there are.
  std::size_t NearestFew(const Eigen::Vector3d& query, std::span<unsigned> indices,
                         std::span<double> squared_distances_m2) const;

 private:
  struct Index;
  std::unique_ptr<const Index> index_;
};

}  // namespace sextant
