// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "geometry/point_cloud.h"

namespace sextant {

/// How many times more returns a cloud has than a scan of any sensor in a second, rounded up; 1 for
/// up to two million. What only scans need, such as rings and boards, is looked for in one return
/// of so many.
std::size_t ThinningOf(const PointCloud& scan);

/// One return of `step`, with the other fields.
PointCloud Thinned(const PointCloud& scan, std::size_t step);

}  // namespace sextant
