// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "solvers/kernels/kabsch.h"

namespace sextant {

/// The points of many problems of equally many pairs, eight problems side by side. All are zero at
/// first.
class PointBatch {
 public:
  /// How many problems are computed on at a time.
  static constexpr std::size_t kGroup = 8;

  PointBatch(std::size_t problems, std::size_t points_per_problem);

  std::size_t problems() const { return problems_; }
  std::size_t points_per_problem() const { return points_; }

  void Set(std::size_t problem, std::size_t point, const Eigen::Vector3d& in_b,
           const Eigen::Vector3d& in_a) {
    double* number = numbers_.data() + Offset(problem / kGroup, point) + problem % kGroup;
    for (int axis = 0; axis < 3; ++axis, number += kGroup) *number = in_a[axis];
    for (int axis = 0; axis < 3; ++axis, number += kGroup) *number = in_b[axis];
  }

  /// x, y, z in a, then in b, of a point in eight problems, a coordinate's eight numbers together;
  /// the next point follows.
  const double* Group(std::size_t group) const { return numbers_.data() + Offset(group, 0); }

 private:
  std::size_t Offset(std::size_t group, std::size_t point) const {
    return (group * points_ + point) * 6 * kGroup;
  }

  std::size_t problems_;
  std::size_t points_;
  std::vector<double> numbers_;
};

/// FitKabsch of every problem, unweighted, each as if it were alone: what eight problems cost is
/// less than two of FitKabsch. Degenerate and mirrored problems say so in their own outcome.
/// Shape: as many fits as problems.
void FitKabschBatch(const PointBatch& batch, std::span<KabschOutcome> fits);

}  // namespace sextant
