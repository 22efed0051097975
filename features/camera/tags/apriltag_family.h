// SPDX-License-Identifier: Apache-2.0
#pragma once

extern "C" {
#include <apriltag/apriltag.h>
}

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace sextant {

using AprilTagFamily = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

/// "tag36h11", "tag25h9" and so on, the names of the AprilTag library.
const std::vector<std::string>& AprilTagFamilyNames();

/// The library's family; null if it has none of that name.
AprilTagFamily MakeAprilTagFamily(std::string_view name);

using AprilTagImage = std::unique_ptr<image_u8_t, void (*)(image_u8_t*)>;

/// The tag as it is printed, one pixel per cell. `id` is one of the family.
AprilTagImage DrawAprilTag(apriltag_family_t& family, int id);

}  // namespace sextant
