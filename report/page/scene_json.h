// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "report/page/page.h"

namespace sextant {

/// The data of the 3D view, as JSON for a script element (ScriptJson): the palette, each sensor's
/// pose, and of each view its boards and its scan. Coordinates of a scan are 16-bit multiples of
/// `unit_m` in base 64, 1 mm up to 32 m away.
std::string SceneJson(const ReportPage& page);

}  // namespace sextant
