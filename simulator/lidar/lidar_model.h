// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

/// One laser of a turning head.
struct LidarRing {
  double elevation_rad = 0.0;       ///< Above the LiDAR's x-y plane.
  double azimuth_offset_rad = 0.0;  ///< Counter-clockwise from above, added to the head's azimuth.
  double firing_time_s = 0.0;       ///< After the start of its column; the head turns on meanwhile.
  double origin_height_m = 0.0;     ///< Where the beam crosses the turning axis, above the origin.
};

/// Two prisms that turn about the x axis and bend one beam each by the same angle, as unit vectors
/// in the plane: (y, z) = deflection (e(first t) + e(second t)), e(a) = (cos a, sin a).
struct LidarRosette {
  double deflection_rad = 0.0;
  double first_rate_rad_s = 0.0;
  double second_rate_rad_s = 0.0;
};

/// How a LiDAR measures. Either `rings` or `rosette` is given.
///
/// A column is one firing of every ring; a scan is one turn. Column k of a scan begins at
/// k column_period_s with the head at start_azimuth -+ 2 pi k column_period_s / turn_period_s.
struct LidarModel {
  std::string name{};
  std::string title{};           ///< Maker and product.
  std::string source{};          ///< Data sheet that the figures come from.
  std::string approximations{};  ///< What is not from it.

  std::vector<LidarRing> rings{};  ///< From the lowest.
  std::optional<LidarRosette> rosette{};
  double turn_period_s = 0.1;
  double column_period_s = 0.0;
  bool clockwise = true;  ///< Sense of turning, seen from above.
  double start_azimuth_rad = 0.0;
  double start_jitter_rad = 0.0;      ///< Each scan starts uniformly within +-this.
  double beam_origin_radius_m = 0.0;  ///< Beams begin this far from the axis, in head's direction.

  double range_sigma_m = 0.0;
  double bias_m = 0.0;             ///< Added to every range.
  double ring_bias_sigma_m = 0.0;  ///< Each ring of a unit has a constant bias of its own besides.
  double range_step_m = 0.0;       ///< Ranges are multiples of it.
  double min_range_m = 0.0;
  double max_range_m = 0.0;

  double divergence_h_rad = 0.0;  ///< Full angle; the spot is an evenly lit rectangle.
  double divergence_v_rad = 0.0;
  double aperture_h_m = 0.0;  ///< Size of the spot as it leaves.
  double aperture_v_m = 0.0;
  double pulse_length_m = 0.0;  ///< Surfaces nearer to each other in range give one return.

  /// A dim spot is measured too far and with more noise: at effective reflectivity (that of the
  /// surface by the cosine of incidence and the share of the spot) 0 by as much as said here, less
  /// in proportion up to dim_reflectivity, from where on it is not dim.
  double dim_bias_m = 0.0;
  double dim_sigma_m = 0.0;  ///< Sigma at 0; not less than range_sigma_m where dim_* are given.
  double dim_reflectivity = 0.0;

  double detection_range_m = 0.0;       ///< Up to here a surface of detection_reflectivity, seen
  double detection_reflectivity = 0.1;  ///< squarely by the whole spot, always gives a return.
  double dropout = 0.0;                 ///< Probability that any other return is lost.
  /// Probability that one is lost whose spot lies half on black and half on white print; with a
  /// share s on black it is 4 s (1 - s) times that.
  double contrast_dropout = 0.0;
  /// Probability that one is lost of which hardly any of the spot is lit; with a lit share s it is
  /// 1 - 2 s times that, and 0 from s = 1/2 on.
  double edge_dropout = 0.0;
  double intensity_scale = 100.0;  ///< Intensity of a white surface seen squarely.
  double intensity_max = 255.0;
};

/// Columns of a turn; of a rosette, its points in that time. Requires a valid model.
int ColumnCount(const LidarModel& model);

/// Errors: kNonFinite and kInvalidInput for a model that nothing could be, naming its field.
Expected<void> ValidateLidarModel(const LidarModel& model);

/// "vlp16", "hdl32e", "hdl64e", "os1_64", "os1_128", "pandar40p", "livox".
const std::vector<std::string>& LidarModelNames();

/// Error: kUnknownName, with the nearest known.
Expected<LidarModel> FindLidarModel(std::string_view name);

}  // namespace sextant
