// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace sextant {

// Files that are compiled in (report/page/assets and, where it is installed, three.js).
std::string_view PageStyle();    ///< CSS.
std::string_view PageScript();   ///< JavaScript of the page.
std::string_view LiveScript();   ///< JavaScript of the page of a capture.
std::string_view SceneScript();  ///< JavaScript of the 3D view, which needs three.js.
/// three.js with its OrbitControls; empty in a build without it.
std::string_view ThreeScript();
std::string_view ThreeLicence();

}  // namespace sextant
