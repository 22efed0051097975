// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <numbers>

#include "simulator/lidar/lidar_models.h"

namespace sextant {
namespace {

// All pixels of a column fire at once. The emitters are staggered in four columns, hence the
// azimuth offsets.
LidarModel Ouster(int rings, double top_deg, double azimuth_step_deg, double divergence_deg) {
  LidarModel model;
  model.source = "OS1 data sheet (2018)";
  model.approximations =
      "evenly spaced elevations and azimuth offsets as published for typical units; lost returns "
      "as for the VLP-16; sigma at high signal; range steps of 1 mm as in recordings, not 12 mm as "
      "in the data sheet";
  for (int i = 0; i < rings; ++i) {
    LidarRing ring;
    ring.elevation_rad = FromDegrees(-top_deg + 2.0 * top_deg * i / (rings - 1));
    ring.azimuth_offset_rad = FromDegrees(azimuth_step_deg * (1.5 - i % 4));
    model.rings.push_back(ring);
  }
  model.turn_period_s = 0.1;
  model.column_period_s = model.turn_period_s / 1024.0;
  model.clockwise = true;
  model.start_azimuth_rad = std::numbers::pi;
  model.beam_origin_radius_m = 0.012163;
  model.range_sigma_m = 0.015;
  model.range_step_m = 0.001;
  model.min_range_m = 0.8;
  model.max_range_m = 120.0;
  model.divergence_h_rad = FromDegrees(divergence_deg);
  model.divergence_v_rad = FromDegrees(divergence_deg);
  model.aperture_h_m = 0.010;
  model.aperture_v_m = 0.010;
  model.pulse_length_m = 1.0;
  model.detection_range_m = 40.0;
  model.dropout = 0.003;
  return model;
}

}  // namespace

LidarModel Os1With64Rings() {
  LidarModel model = Ouster(64, 16.611, 2.109, 0.13);
  model.title = "Ouster OS1-64 (first generation), 1024 x 10 Hz";
  return model;
}

LidarModel Os1With128Rings() {
  LidarModel model = Ouster(128, 22.5, 2.82, 0.18);
  model.title = "Ouster OS1-128, 1024 x 10 Hz";
  return model;
}

LidarModel Pandar40p() {
  LidarModel model;
  model.title = "Hesai Pandar40P";
  model.source = "Pandar40P User Manual, 402-en-2002A2 (2020)";
  model.approximations =
      "spot as for the VLP-16; evenly spaced firings, from the highest ring; lost returns as for "
      "the VLP-16";
  constexpr int kChannels = 40;
  // From the manual's table, starting with channel 40, the lowest.
  constexpr std::array kLowDeg = {-25.0, -19.0, -14.0, -13.0, -12.0, -11.0,
                                  -10.0, -9.0,  -8.0,  -7.0,  -6.0};
  constexpr std::array kHighDeg = {3.0, 5.0, 8.0, 11.0, 15.0};
  model.column_period_s = 0.1 / 1800.0;
  for (int i = 0; i < kChannels; ++i) {
    LidarRing ring;
    double elevation_deg = (i - 28) / 3.0;  // Steps of a third of a degree from -6 to 2.
    if (i < static_cast<int>(kLowDeg.size())) {
      elevation_deg = kLowDeg[static_cast<std::size_t>(i)];
    } else if (i >= 35) {
      elevation_deg = kHighDeg[static_cast<std::size_t>(i - 35)];
    }
    ring.elevation_rad = FromDegrees(elevation_deg);
    // Clockwise in the manual. Channels 7 to 30 are in three columns of emitters, the others in
    // one.
    constexpr std::array kClockwiseDeg = {-1.042, 3.125, -5.208};
    const int channel = kChannels - i;
    const bool staggered = channel >= 7 && channel <= 30;
    ring.azimuth_offset_rad =
        -FromDegrees(kClockwiseDeg[static_cast<std::size_t>(staggered ? (channel - 6) % 3 : 0)]);
    ring.firing_time_s = model.column_period_s * (channel - 1) / kChannels;
    model.rings.push_back(ring);
  }
  model.turn_period_s = 0.1;
  model.clockwise = true;
  model.start_azimuth_rad = std::numbers::pi;
  model.start_jitter_rad = FromDegrees(0.1);
  model.range_sigma_m = 0.02;
  model.range_step_m = 0.004;
  model.min_range_m = 0.3;
  model.max_range_m = 200.0;
  model.divergence_h_rad = 0.003;
  model.divergence_v_rad = 0.0015;
  model.aperture_h_m = 0.0127;
  model.aperture_v_m = 0.0095;
  model.pulse_length_m = 1.0;
  model.detection_range_m = 200.0;
  model.dropout = 0.003;
  return model;
}

LidarModel LivoxMid40() {
  LidarModel model;
  model.title = "Livox Mid-40";
  model.source = "Livox Mid Series User Manual v1.0 (2019)";
  model.approximations =
      "two thin prisms of equal strength at 7294 and -4664 revolutions per minute; size of the "
      "spot at the aperture; lost returns as for the VLP-16";
  constexpr double kPerMinute = 2.0 * std::numbers::pi / 60.0;
  model.rosette = LidarRosette{.deflection_rad = FromDegrees(38.4 / 4.0),
                               .first_rate_rad_s = 7294.0 * kPerMinute,
                               .second_rate_rad_s = -4664.0 * kPerMinute};
  model.turn_period_s = 0.1;
  model.column_period_s = 1e-5;
  model.range_sigma_m = 0.02;
  model.range_step_m = 0.001;
  model.min_range_m = 1.0;
  model.max_range_m = 260.0;
  model.divergence_h_rad = FromDegrees(0.03);
  model.divergence_v_rad = FromDegrees(0.28);
  model.aperture_h_m = 0.005;
  model.aperture_v_m = 0.005;
  model.pulse_length_m = 1.0;
  model.detection_range_m = 90.0;
  model.dropout = 0.003;
  return model;
}

}  // namespace sextant
