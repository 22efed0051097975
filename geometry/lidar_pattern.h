// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace sextant {

/// Sampling pattern and noise of a spinning LiDAR: the parameters for predicting a scan.
struct LidarPattern {
  std::vector<double> elevations_rad{};  ///< The rings, ascending.
  double azimuth_step_rad = 0.0;         ///< Between samples of a ring.
  double range_sigma_m = 0.0;            ///< Along the ray.
  double aperture_m = 0.0;               ///< Diameter of the beam where it leaves the sensor.
  double divergence_rad = 0.0;           ///< Full angle by which the beam widens.
};

}  // namespace sextant
