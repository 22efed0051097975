// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <numbers>

#include "simulator/lidar/lidar_models.h"

namespace sextant {
namespace {

constexpr double kMicrosecond = 1e-6;

// Common properties of Velodyne's rotating sensors. Size of the spot at the aperture and its
// divergence: table of the laser pulse in the manuals, which also state that two returns of a pulse
// are at least a metre apart.
LidarModel Velodyne() {
  LidarModel model;
  model.turn_period_s = 0.1;
  model.clockwise = true;
  model.start_azimuth_rad = std::numbers::pi;
  model.range_step_m = 0.002;
  model.aperture_h_m = 0.0127;
  model.aperture_v_m = 0.0095;
  model.divergence_h_rad = 0.003;
  model.divergence_v_rad = 0.0015;
  model.pulse_length_m = 1.0;
  model.dropout = 0.003;
  return model;
}

}  // namespace

// Noise, biases and lost returns are not in the data sheet ("+-3 cm typical"). They were measured
// on the seven recordings of a checkerboard in the public data of acfr/cam_lidar_calibration, taken
// with one VLP-16 at 1.7 to 2.9 m, by a joint least-squares fit of one plane per recording, one
// bias per ring and one bias of black (4808 points, docs/simulator.md).
LidarModel Vlp16() {
  LidarModel model = Velodyne();
  model.title = "Velodyne VLP-16";
  model.source = "VLP-16 User Manual, 63-9243 Rev. D (2018)";
  model.approximations =
      "noise, biases of rings and of black, and lost returns measured on one unit; divergence of "
      "the VLS-128";
  constexpr int kLasers = 16;
  model.rings.resize(kLasers);
  for (int laser = 0; laser < kLasers; ++laser) {
    // The lasers fire alternately in the lower and the upper half.
    const int elevation_deg = laser % 2 == 0 ? laser - 15 : laser;
    LidarRing& ring = model.rings[static_cast<std::size_t>((elevation_deg + 15) / 2)];
    ring.elevation_rad = FromDegrees(elevation_deg);
    ring.firing_time_s = 2.304 * kMicrosecond * laser;
    // Reproduces the manual's vertical corrections, 11.2 mm at -15 degrees to -11.2 mm, to 0.1 mm.
    ring.origin_height_m = -0.0418 * std::tan(ring.elevation_rad);
  }
  model.column_period_s = 55.296 * kMicrosecond;
  model.start_jitter_rad = std::numbers::pi * model.column_period_s / model.turn_period_s;
  model.range_sigma_m = 0.009;
  model.ring_bias_sigma_m = 0.0095;
  model.dim_bias_m = 0.017;
  model.dim_sigma_m = 0.0138;
  model.dim_reflectivity = 0.15;
  model.contrast_dropout = 0.55;
  model.edge_dropout = 1.0;
  model.min_range_m = 0.4;
  model.max_range_m = 100.0;
  model.detection_range_m = 50.0;
  return model;
}

LidarModel Hdl32e() {
  LidarModel model = Velodyne();
  model.title = "Velodyne HDL-32E";
  model.source = "HDL-32E User's Manual, 63-9113 Rev. H (2015)";
  model.approximations = "ranges at 10 % reflectivity; lost returns as for the VLP-16";
  constexpr int kLasers = 32;
  model.rings.resize(kLasers);
  for (int laser = 0; laser < kLasers; ++laser) {
    // The lasers fire alternately in two banks of 16, each from the lowest; 4/3 of a degree apart.
    const int ring_number = laser % 2 == 0 ? laser / 2 : 16 + laser / 2;
    LidarRing& ring = model.rings[static_cast<std::size_t>(ring_number)];
    ring.elevation_rad = FromDegrees((4.0 * ring_number - 92.0) / 3.0);
    ring.firing_time_s = 1.152 * kMicrosecond * laser;
  }
  model.column_period_s = 46.08 * kMicrosecond;
  model.start_jitter_rad = std::numbers::pi * model.column_period_s / model.turn_period_s;
  model.range_sigma_m = 0.02;
  model.min_range_m = 1.0;
  model.max_range_m = 100.0;
  model.detection_range_m = 50.0;
  return model;
}

LidarModel Hdl64e() {
  LidarModel model = Velodyne();
  model.title = "Velodyne HDL-64E S3";
  model.source = "HDL-64E S3 User's Manual, 63-HDL64ES3 Rev. G (2013)";
  model.approximations =
      "rings evenly spaced in both blocks and without azimuth offsets (each unit has its own "
      "calibration); evenly spaced firings, both blocks at once; round spot";
  constexpr int kLasersPerBlock = 32;
  model.column_period_s = 48.0 * kMicrosecond;
  const double between_firings_s = model.column_period_s / kLasersPerBlock;
  for (int i = 0; i < 2 * kLasersPerBlock; ++i) {
    const bool lower = i < kLasersPerBlock;
    const int in_block = i % kLasersPerBlock;
    LidarRing ring;
    ring.elevation_rad =
        FromDegrees(lower ? -24.33 + 0.5 * in_block : -25.0 / 3.0 + in_block / 3.0);
    ring.firing_time_s = between_firings_s * in_block;
    model.rings.push_back(ring);
  }
  model.start_jitter_rad = std::numbers::pi * model.column_period_s / model.turn_period_s;
  model.range_sigma_m = 0.02;
  model.divergence_h_rad = 0.002;
  model.divergence_v_rad = 0.002;
  model.min_range_m = 0.9;
  model.max_range_m = 120.0;
  model.detection_range_m = 50.0;
  return model;
}

}  // namespace sextant
