// SPDX-License-Identifier: Apache-2.0
#include "report/thinned_scan.h"

namespace sextant {
namespace {

template <class T>
std::vector<T> EveryNth(const std::vector<T>& values, std::size_t step) {
  std::vector<T> kept;
  kept.reserve(values.size() / step + 1);
  for (std::size_t i = 0; i < values.size(); i += step) kept.push_back(values[i]);
  return kept;
}

}  // namespace

std::size_t ThinningOf(const PointCloud& scan) {
  constexpr std::size_t kMaxReturns = 2'000'000;
  return scan.points.size() / (kMaxReturns + 1) + 1;
}

PointCloud Thinned(const PointCloud& scan, std::size_t step) {
  return {.points = EveryNth(scan.points, step),
          .intensity = EveryNth(scan.intensity, step),
          .ring = EveryNth(scan.ring, step),
          .time_s = EveryNth(scan.time_s, step)};
}

}  // namespace sextant
