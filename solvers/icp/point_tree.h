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
  /// The points [m] must outlive the tree. n log n to build, 4 bytes a point.
  explicit PointTree(std::span<const Eigen::Vector3d> points);
  ~PointTree();
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;

  struct Neighbour {
    int index = -1;  ///< -1 where no point is closer than asked for.
    double squared_distance_m2 = 0.0;
  };

  /// The nearest point that is closer than sqrt(closer_than_m2). `hint` may name a point that is
  /// likely near (-1 for none): the search is the faster for it and its answer is the same.
  Neighbour Nearest(const Eigen::Vector3d& query, double closer_than_m2, int hint = -1) const;

  /// Fills `indices` with the nearest points, nearest first, and returns how many there are.
  std::size_t NearestFew(const Eigen::Vector3d& query, std::span<unsigned> indices,
                         std::span<double> squared_distances_m2) const;

 private:
  struct Index;
  std::unique_ptr<const Index> index_;
};

}  // namespace sextant
