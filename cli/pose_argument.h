// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant::cli {

/// A pose given as an option: a file for ReadPoseFile, or the seven values X Y Z QW QX QY QZ.
/// Errors: kInvalidOption, with the option's name; those of the files' readers.
Expected<Rigid3d> PoseFromArgument(const std::string& option,
                                   const std::vector<std::string>& values);

}  // namespace sextant::cli
