// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rings/ring_order.h"

#include <algorithm>
#include <optional>

#include "features/lidar/rings/ring_line.h"

namespace sextant {
namespace {

constexpr std::size_t kMinOrderedRings = 4;
constexpr std::size_t kMaxOrderedRings = 256;
constexpr std::size_t kMinColumns = 16;
constexpr std::size_t kTestedColumns = 48;

// A layout of an ordered cloud.
struct PointOrder {
  std::size_t rings = 0;
  std::size_t columns = 0;
  bool column_by_column = true;  // Else ring by ring.

  std::size_t RingOf(std::size_t index) const {
    return column_by_column ? index % rings : index / columns;
  }
  std::size_t ColumnOf(std::size_t index) const {
    return column_by_column ? index / rings : index % columns;
  }
};

bool IsOrder(std::span<const UnsortedReturn> returns, const PointOrder& order) {
  // Pairs of neighbouring columns, evenly spread: in a layout with too few rings, a column and its
  // neighbour hold different rings.
  const std::size_t stride = std::max<std::size_t>(1, order.columns / kTestedColumns);
  std::vector<std::vector<ConePlace>> places(order.rings);
  for (const UnsortedReturn& point : returns) {
    if (order.ColumnOf(point.index) % stride > 1) continue;
    places[order.RingOf(point.index)].push_back(ConePlace::Of(point));
  }
  const auto known = std::ranges::count_if(places, [](const auto& ring) { return !ring.empty(); });
  return 2 * static_cast<std::size_t>(known) >= order.rings && AreNarrow(places);
}

std::optional<PointOrder> FindOrder(std::span<const UnsortedReturn> returns,
                                    std::size_t cloud_size) {
  for (std::size_t rings = kMinOrderedRings; rings <= kMaxOrderedRings; ++rings) {
    if (cloud_size % rings != 0 || cloud_size / rings < kMinColumns) continue;
    for (const bool column_by_column : {true, false}) {
      const PointOrder order{rings, cloud_size / rings, column_by_column};
      if (IsOrder(returns, order)) return order;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<int> RingsByOrder(std::span<const UnsortedReturn> returns, std::size_t cloud_size) {
  std::vector<int> numbers;
  const std::optional<PointOrder> order = FindOrder(returns, cloud_size);
  if (!order) return numbers;
  for (const UnsortedReturn& point : returns) {
    numbers.push_back(static_cast<int>(order->RingOf(point.index)));
  }
  return numbers;
}

}  // namespace sextant
