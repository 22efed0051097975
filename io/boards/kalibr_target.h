// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/board.h"
#include "io/text/yaml_fields.h"

namespace sextant {

/// Whether a document is the description of a target for Kalibr (it states `target_type`).
bool IsKalibrTarget(const YamlNode& root);

/// Board 0 with Kalibr's target: an `aprilgrid` (tagCols, tagRows, tagSize, tagSpacing) or a
/// `checkerboard` (targetCols, targetRows, rowSpacingMeters, colSpacingMeters: inner corners).
///
/// Kalibr does not state the size of the plate that carries the target. `top_right_m` and
/// `right_bottom_m` may be added to the file; without them the plate is as large as the print.
/// Errors go to `in`: other types, unequal spacings of a checkerboard, FindBoardFault.
Board ReadKalibrTarget(YamlFields& in, const YamlNode& root);

}  // namespace sextant
