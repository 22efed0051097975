// SPDX-License-Identifier: Apache-2.0
#include "solvers/matching/min_cost_assignment.h"

#include <cassert>
#include <cstddef>
#include <limits>

namespace sextant {
namespace {

// Indices begin at 1; 0 is a column that stands for "none" while a path is looked for.
class AssignmentPaths {
 public:
  AssignmentPaths(std::span<const double> costs, int n) : costs_(costs), n_(n) {}

  // Assigns one more row by the shortest augmenting path from it.
  void Add(int row) {
    row_of_[0] = row;
    int column = 0;
    std::array<double, kSize> distance;
    std::array<bool, kSize> visited{};
    distance.fill(std::numeric_limits<double>::infinity());
    do {
      visited[Index(column)] = true;
      column = Grow(column, distance, visited);
    } while (row_of_[Index(column)] != 0);
    while (column != 0) {
      const int before = before_[Index(column)];
      row_of_[Index(column)] = row_of_[Index(before)];
      column = before;
    }
  }

  MinCostAssignment Result() const {
    MinCostAssignment result;
    for (int column = 1; column <= n_; ++column) {
      const int row = row_of_[Index(column)];
      result.column_of_row[Index(row - 1)] = column - 1;
      result.cost += Cost(row, column);
    }
    return result;
  }

 private:
  static constexpr std::size_t kSize = kMaxAssigned + 1;
  static std::size_t Index(int i) { return static_cast<std::size_t>(i); }
  double Cost(int row, int column) const { return costs_[Index(n_ * (row - 1) + column - 1)]; }

  // Relaxes the columns from `column`'s row and returns the nearest one that was not visited.
  int Grow(int column, std::array<double, kSize>& distance, std::array<bool, kSize>& visited) {
    const int row = row_of_[Index(column)];
    int nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int j = 1; j <= n_; ++j) {
      if (visited[Index(j)]) continue;
      const double reduced = Cost(row, j) - row_price_[Index(row)] - column_price_[Index(j)];
      if (reduced < distance[Index(j)]) {
        distance[Index(j)] = reduced;
        before_[Index(j)] = column;
      }
      if (distance[Index(j)] < least) {
        least = distance[Index(j)];
        nearest = j;
      }
    }
    for (int j = 0; j <= n_; ++j) {
      if (visited[Index(j)]) {
        row_price_[Index(row_of_[Index(j)])] += least;
        column_price_[Index(j)] -= least;
      } else {
        distance[Index(j)] -= least;
      }
    }
    return nearest;
  }

  std::span<const double> costs_;
  int n_;
  std::array<double, kSize> row_price_{};
  std::array<double, kSize> column_price_{};
  std::array<int, kSize> row_of_{};
  std::array<int, kSize> before_{};
};

}  // namespace

MinCostAssignment AssignAtMinCost(std::span<const double> costs, int n) {
  assert(n <= kMaxAssigned && costs.size() >= static_cast<std::size_t>(n * n));
  AssignmentPaths paths(costs, n);
  for (int row = 1; row <= n; ++row) paths.Add(row);
  return paths.Result();
}

}  // namespace sextant
