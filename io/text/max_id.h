// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace sextant {

/// The largest id of a board, tag or view that is read; the sum of two ids still fits an int.
inline constexpr int kMaxId = 1'000'000'000;

/// The most boards in one file: some checks compare each board, or each tag of a board, with all
/// others.
inline constexpr std::size_t kMaxBoards = 1000;

}  // namespace sextant
