// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <array>
#include <cmath>

#include "simulator/lidar/lidar_model.h"

namespace sextant {
namespace {

struct Field {
  const char* name;
  double value;
};

Expected<void> Refuse(const LidarModel& model, const std::string& what) {
  return MakeError(ErrorCode::kInvalidInput, fmt::format("LiDAR model '{}': {}", model.name, what));
}

// Lengths, times and probabilities, which must not be negative.
std::array<Field, 22> FieldsOf(const LidarModel& model) {
  return {{{"turn_period_s", model.turn_period_s},
           {"column_period_s", model.column_period_s},
           {"start_jitter_rad", model.start_jitter_rad},
           {"beam_origin_radius_m", model.beam_origin_radius_m},
           {"range_sigma_m", model.range_sigma_m},
           {"ring_bias_sigma_m", model.ring_bias_sigma_m},
           {"range_step_m", model.range_step_m},
           {"min_range_m", model.min_range_m},
           {"max_range_m", model.max_range_m},
           {"divergence_h_rad", model.divergence_h_rad},
           {"divergence_v_rad", model.divergence_v_rad},
           {"aperture_h_m", model.aperture_h_m},
           {"aperture_v_m", model.aperture_v_m},
           {"pulse_length_m", model.pulse_length_m},
           {"dim_sigma_m", model.dim_sigma_m},
           {"dim_reflectivity", model.dim_reflectivity},
           {"detection_range_m", model.detection_range_m},
           {"detection_reflectivity", model.detection_reflectivity},
           {"dropout", model.dropout},
           {"contrast_dropout", model.contrast_dropout},
           {"edge_dropout", model.edge_dropout},
           {"intensity_scale", model.intensity_scale}}};
}

}  // namespace

Expected<void> ValidateLidarModel(const LidarModel& model) {
  for (const Field& field : FieldsOf(model)) {
    if (!std::isfinite(field.value)) {
      return MakeError(ErrorCode::kNonFinite,
                       fmt::format("LiDAR model '{}': {} is not finite", model.name, field.name));
    }
    if (field.value < 0.0) {
      return Refuse(model,
                    fmt::format("{} is {}, but cannot be negative", field.name, field.value));
    }
  }
  if (model.rings.empty() == !model.rosette.has_value()) {
    return Refuse(model, "either rings or a rosette is needed");
  }
  if (model.column_period_s == 0.0 || model.turn_period_s < model.column_period_s) {
    return Refuse(model, fmt::format("a turn of {} s does not hold a column of {} s",
                                     model.turn_period_s, model.column_period_s));
  }
  constexpr double kMaxBeams = 1e8;
  const double beams = model.rosette ? 1.0 : static_cast<double>(model.rings.size());
  if (beams * model.turn_period_s / model.column_period_s > kMaxBeams) {
    return Refuse(model, "more than 100 million beams a scan");
  }
  for (std::size_t i = 0; i < model.rings.size(); ++i) {
    const LidarRing& ring = model.rings[i];
    if (!std::isfinite(ring.elevation_rad + ring.azimuth_offset_rad + ring.firing_time_s +
                       ring.origin_height_m)) {
      return MakeError(ErrorCode::kNonFinite,
                       fmt::format("LiDAR model '{}': ring {} is not finite", model.name, i));
    }
    if (i > 0 && ring.elevation_rad <= model.rings[i - 1].elevation_rad) {
      return Refuse(model, fmt::format("ring {} is not above ring {}", i, i - 1));
    }
  }
  if (model.max_range_m <= model.min_range_m) {
    return Refuse(model, fmt::format("max_range_m is {} m, min_range_m {} m", model.max_range_m,
                                     model.min_range_m));
  }
  if (model.dropout > 1.0 || model.contrast_dropout > 1.0 || model.edge_dropout > 1.0) {
    return Refuse(model, "a probability of lost returns is above 1");
  }
  if (model.detection_range_m == 0.0 || model.detection_reflectivity == 0.0) {
    return Refuse(model, "detection_range_m and detection_reflectivity must be positive");
  }
  return {};
}

}  // namespace sextant
