// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

/// One laser of a rotating head.
struct LidarRing {
  double elevation_rad = 0.0;  ///< Above the LiDAR's x-y plane.
  /// Added to the head's azimuth; counter-clockwise seen from above.
  double azimuth_offset_rad = 0.0;
  double firing_time_s = 0.0;  ///< After the start of its column; the head keeps rotating.
  /// Height above the origin at which the beam crosses the rotation axis.
  double origin_height_m = 0.0;
};

/// Two prisms that rotate about the x axis and each deflect the beam by the same angle: (y, z) =
/// deflection (e(first t) + e(second t)) with e(a) = (cos a, sin a).
struct LidarRosette {
  double deflection_rad = 0.0;
  double first_rate_rad_s = 0.0;
  double second_rate_rad_s = 0.0;
};

/// Measurement model of a LiDAR. Exactly one of `rings` and `rosette` is given.
///
/// A column is one firing of every ring; a scan is one revolution. Column k of a scan begins at k
/// column_period_s with the head at start_azimuth -+ 2 pi k column_period_s / turn_period_s.
struct LidarModel {
  std::string name{};
  std::string title{};           ///< Manufacturer and product.
  std::string source{};          ///< Data sheet of the figures.
  std::string approximations{};  ///< Figures that are not from the data sheet.

  std::vector<LidarRing> rings{};  ///< From the lowest to the highest.
  std::optional<LidarRosette> rosette{};
  double turn_period_s = 0.1;
  double column_period_s = 0.0;
  bool clockwise = true;  ///< Sense of rotation, seen from above.
  double start_azimuth_rad = 0.0;
  /// The start azimuth of each scan varies uniformly within +-this.
  double start_jitter_rad = 0.0;
  /// Distance of the beams' origins from the axis, in the head's direction.
  double beam_origin_radius_m = 0.0;

  double range_sigma_m = 0.0;
  double bias_m = 0.0;  ///< Added to every range.
  /// Standard deviation of an additional constant bias per ring of a unit.
  double ring_bias_sigma_m = 0.0;
  double range_step_m = 0.0;  ///< Ranges are multiples of this.
  double min_range_m = 0.0;
  double max_range_m = 0.0;

  double divergence_h_rad = 0.0;  ///< Full angle; the spot is a uniformly illuminated rectangle.
  double divergence_v_rad = 0.0;
  double aperture_h_m = 0.0;  ///< Size of the spot at the aperture.
  double aperture_v_m = 0.0;
  double pulse_length_m = 0.0;  ///< Surfaces closer than this in range give one return.

  /// Weak returns are measured too far and with more noise. The effect decreases linearly with the
  /// effective reflectivity (surface reflectivity times cosine of incidence times fraction of the
  /// spot): the values given here apply at 0, and there is no effect from dim_reflectivity on.
  double dim_bias_m = 0.0;
  double dim_sigma_m = 0.0;  ///< Sigma at 0; at least range_sigma_m if dim_* are given.
  double dim_reflectivity = 0.0;

  /// Up to this range, a surface of detection_reflectivity that faces the LiDAR and is hit by the
  /// whole spot always gives a return.
  double detection_range_m = 0.0;
  double detection_reflectivity = 0.1;
  double dropout = 0.0;  ///< Probability of losing any other return.
  /// Probability of losing a return whose spot is half on black and half on white print; with a
  /// fraction s on black it is 4 s (1 - s) times this.
  double contrast_dropout = 0.0;
  /// Probability of losing a return of which almost nothing of the spot contributes; with a
  /// contributing fraction s it is (1 - 2 s) times this, and 0 from s = 1/2 on.
  double edge_dropout = 0.0;
  double intensity_scale = 100.0;  ///< Intensity of a white surface at normal incidence.
  double intensity_max = 255.0;
};

/// Number of columns per revolution; for a rosette, the number of points in that time. Requires a
/// valid model.
int ColumnCount(const LidarModel& model);

/// Errors: kNonFinite and kInvalidInput for an impossible model; messages name the field.
Expected<void> ValidateLidarModel(const LidarModel& model);

/// "vlp16", "hdl32e", "hdl64e", "os1_64", "os1_128", "pandar40p", "livox".
const std::vector<std::string>& LidarModelNames();

/// Error: kUnknownName, with the nearest known name.
Expected<LidarModel> FindLidarModel(std::string_view name);

}  // namespace sextant
