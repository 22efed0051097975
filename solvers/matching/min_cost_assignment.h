// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

namespace sextant {

inline constexpr int kMaxAssigned = 16;

/// Which column each row is assigned to, and the sum of the costs.
struct MinCostAssignment {
  std::array<int, kMaxAssigned> column_of_row{};
  double cost = 0.0;
};

/// The one-to-one assignment of n rows to n columns with the least sum of costs (Kuhn 1955;
/// shortest augmenting paths of Jonker and Volgenant 1987). `costs[n * row + column]` is finite; n
/// is at most kMaxAssigned. O(n^3): about 0.1 us for 4 and 2 us for 12. Allocates nothing.
MinCostAssignment AssignAtMinCost(std::span<const double> costs, int n);

}  // namespace sextant
