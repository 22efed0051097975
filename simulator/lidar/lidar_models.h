// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "simulator/lidar/lidar_model.h"

namespace sextant {

/// The entries of FindLidarModel's table, by maker.
LidarModel Vlp16();
LidarModel Hdl32e();
LidarModel Hdl64e();
LidarModel Os1With64Rings();
LidarModel Os1With128Rings();
LidarModel Pandar40p();
LidarModel LivoxMid40();

/// For figures of data sheets.
double FromDegrees(double degrees);

}  // namespace sextant
