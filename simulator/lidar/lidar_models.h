// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/lidar/lidar_model.h"

namespace sextant {

/// The entries of FindLidarModel's table, by manufacturer.
LidarModel Vlp16();
LidarModel Hdl32e();
LidarModel Hdl64e();
LidarModel Os1With64Rings();
LidarModel Os1With128Rings();
LidarModel Pandar40p();
LidarModel LivoxMid40();

/// Converts degrees, as given in data sheets, to radians.
double FromDegrees(double degrees);

}  // namespace sextant
