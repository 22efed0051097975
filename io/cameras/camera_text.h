// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "geometry/camera.h"
#include "io/text/yaml_node.h"

namespace sextant {

// Time and memory are linear in the size of the text.

/// The cameras of COLMAP's cameras.txt; `name` chooses one by its number. COLMAP's first pixel is
/// centred at (0.5, 0.5), which is subtracted. None for a text of another form. Errors: as
/// ParseNamedCamera; kInvalidInput for models that Camera does not have.
std::optional<Expected<Camera>> ParseCameraColmap(std::string_view text, const std::string& file,
                                                  std::string_view name);

/// A text of assignments, as of Matlab and Python (`K = [600 0 320; 0 600 240; 0 0 1];`), or of
/// numbers alone (3 lines of 3, K row by row, and a fourth of distortion coefficients), as a tree
/// of their names. None for a text of another form, or of more than 64 KiB.
std::optional<YamlNode> TreeOfAssignments(std::string_view text);

}  // namespace sextant
