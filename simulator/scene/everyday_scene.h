// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "simulator/scene/scene.h"

namespace sextant {

enum class EverydayPlace { kRoom, kStreet };

/// "room" or "street"; none for any other name.
std::optional<EverydayPlace> FindEverydayPlace(std::string_view name);

/// A random scene without boards, as a robot or a vehicle meets it; the same seed gives the same
/// scene. The sensors are above the world's origin and look along x; each stands in its own place,
/// so that every one has its own occlusions. Surfaces have random reflectivities and albedos,
/// independent of each other, and prints that no LiDAR sees (windows, posters, lane marks).
/// - Room: 7 to 13 m by 6 to 10 m, with furniture, pillars, persons and pictures. LiDAR at 0.9 m,
///   "vlp16".
/// - Street: facades of different setback, parked vehicles, trees, poles, signs, persons and lane
///   marks, up to 60 m. LiDAR at 1.73 m, "hdl64e".
/// One camera, 1240 x 376 pixels, f 720 px, 13 cm (room) or 28 cm (street) from the LiDAR.
Scene EverydayScene(EverydayPlace place, std::uint64_t seed);

}  // namespace sextant
