// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sextant {

/// The largest id of a board, tag or view that is read; the sum of two ids still fits an int.
inline constexpr int kMaxId = 1'000'000'000;

}  // namespace sextant
