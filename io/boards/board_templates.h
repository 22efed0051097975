// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/board.h"

namespace sextant {

/// "fast_calib", "velo2cam", "multisensor_calibration", "aprilgrid", "charuco": the boards of other
/// programs, as these describe them. Sizes of a board that was made must be measured.
const std::vector<std::string>& BoardTemplateNames();

/// Board 0 of that name. Error: kUnknownName, with a suggestion.
Expected<Board> FindBoardTemplate(std::string_view name);

}  // namespace sextant
