// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "base/error.h"
#include "io/results/calibration_result.h"
#include "io/results/rig_result.h"

namespace sextant {

/// All sensors of a rig in one file: ros1, ros2, ros2_yaml (a publisher for each sensor but the
/// root, root_from_sensor), urdf (a link and a fixed joint each) and kitti (P_<camera> and
/// Tr_<lidar>_to_<camera> for every camera and LiDAR). Frames are named as the sensors. Errors:
/// kUnknownName for another format; kMissingData where fewer than two sensors are connected, and
/// for kitti without cameras; kInvalidOption for a sensor whose name cannot be that of a frame
/// (ExportTransform).
Expected<std::string> ExportRig(std::string_view format, const RigResult& result);

/// a_from_b of two sensors for ExportTransform, as cam_from_lidar with the sensors' names as
/// frames, and with the verdict NOT USABLE where the rig is refuted. Errors: those of
/// RigResult::Between; kInvalidOption where both are one sensor.
Expected<CalibrationResult> ResultOfPair(const RigResult& result, std::string_view a,
                                         std::string_view b);

}  // namespace sextant
