// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sextant {

/// Of boards, tags and views: leaves room for sums of two in an int.
inline constexpr int kMaxId = 1'000'000'000;

}  // namespace sextant
