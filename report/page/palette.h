// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace sextant {

/// Colours from far to near: viridis (Smith and van der Walt 2015, CC0) without its darkest part,
/// which the colour-blind can read and grey printers keep in order.
inline constexpr std::array<std::string_view, 12> kPalette = {
    "#482475", "#414487", "#355f8d", "#2a788e", "#21918c", "#22a884",
    "#44bf70", "#6ece58", "#95d840", "#bddf26", "#dfe318", "#fde725"};

}  // namespace sextant
