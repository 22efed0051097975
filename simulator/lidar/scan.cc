// SPDX-License-Identifier: Apache-2.0
#include "simulator/lidar/scan.h"

#include <fmt/core.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/random.h"
#include "simulator/lidar/lidar_beam.h"

namespace sextant {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

struct Firing {
  LidarRay ray{};
  double time_s = 0.0;  // Time since the start of the scan.
};

// The measurement of a beam, if there is one.
struct Slot {
  std::optional<LidarEcho> echo{};
  Eigen::Vector3d point_in_lidar = Eigen::Vector3d::Zero();
  double time_s = 0.0;
  float intensity = 0.0F;
};

// Simulates one revolution of a rotating head, or a rosette for the same time.
class Scanner {
 public:
  Scanner(const LidarModel& model, const ScanOptions& options, const LidarBeams& beams)
      : model_(model), options_(options), beams_(beams) {
    const auto scan = static_cast<std::uint64_t>(options.scan_index);
    if (options.noise) {
      Random start(DeriveSeed(options.seed, "lidar_start", scan, 0));
      start_azimuth_rad_ = start.Uniform(-model.start_jitter_rad, model.start_jitter_rad);
    }
    start_azimuth_rad_ += model.start_azimuth_rad;
    Random bias(DeriveSeed(options.unit.value_or(options.seed), "lidar_ring_bias", 0, 0));
    for (int ring = 0; ring < Beams(); ++ring) {
      const double deviation = bias.Normal();
      biases_m_.push_back(model.bias_m + model.ring_bias_sigma_m * deviation);
    }
  }

  /// Number of beams per column.
  int Beams() const { return model_.rosette ? 1 : static_cast<int>(model_.rings.size()); }

  void ScanColumn(int column, LidarBeams::Scratch& scratch, Slot* slots) const {
    Random random(DeriveSeed(options_.seed, "lidar_column",
                             static_cast<std::uint64_t>(options_.scan_index),
                             static_cast<std::uint64_t>(column)));
    for (int ring = 0; ring < Beams(); ++ring) {
      // Drawn even without an echo, so that a beam's random numbers do not depend on the scene.
      const double lot = random.Uniform();
      const double deviation = random.Normal();
      const Firing firing = model_.rosette ? RosetteFiring(column) : RingFiring(column, ring);
      const std::optional<LidarEcho> echo =
          beams_.Cast(firing.ray, options_.start_time_s + firing.time_s, scratch);
      if (!echo || (options_.dropouts && lot >= ChanceOfReturn(*echo))) continue;
      slots[ring] = Measure(firing, *echo, biases_m_[static_cast<std::size_t>(ring)], deviation);
    }
  }

 private:
  Firing RingFiring(int column, int ring) const {
    const LidarRing& laser = model_.rings[static_cast<std::size_t>(ring)];
    Firing firing;
    firing.time_s = column * model_.column_period_s + laser.firing_time_s;
    const double turned = kTurn * firing.time_s / model_.turn_period_s;
    const double head = start_azimuth_rad_ + (model_.clockwise ? -turned : turned);
    const double azimuth = head + laser.azimuth_offset_rad;
    const double level = std::cos(laser.elevation_rad);
    firing.ray.direction = {level * std::cos(azimuth), level * std::sin(azimuth),
                            std::sin(laser.elevation_rad)};
    firing.ray.origin = {model_.beam_origin_radius_m * std::cos(head),
                         model_.beam_origin_radius_m * std::sin(head), laser.origin_height_m};
    return firing;
  }

  // The pattern continues from scan to scan.
  Firing RosetteFiring(int column) const {
    const LidarRosette& prisms = *model_.rosette;
    Firing firing;
    firing.time_s = column * model_.column_period_s;
    const double time_s = options_.start_time_s + firing.time_s;
    const double first = prisms.first_rate_rad_s * time_s;
    const double second = prisms.second_rate_rad_s * time_s;
    const double y = prisms.deflection_rad * (std::cos(first) + std::cos(second));
    const double z = prisms.deflection_rad * (std::sin(first) + std::sin(second));
    const double angle = std::hypot(y, z);
    const double scale = angle > 0.0 ? std::sin(angle) / angle : 1.0;
    firing.ray.direction = {std::cos(angle), scale * y, scale * z};
    return firing;
  }

  double ChanceOfReturn(const LidarEcho& echo) const {
    // Certain from the echo power of the data sheet's target on, impossible below half of it.
    const double needed =
        model_.detection_reflectivity / (model_.detection_range_m * model_.detection_range_m);
    const double strong = std::clamp(2.0 * echo.power / needed - 1.0, 0.0, 1.0);
    const double uneven = 4.0 * echo.black_share * (1.0 - echo.black_share);
    const double rim = std::max(0.0, 1.0 - 2.0 * echo.lit_share);
    return strong * (1.0 - model_.dropout) * (1.0 - model_.contrast_dropout * uneven) *
           (1.0 - model_.edge_dropout * rim);
  }

  Slot Measure(const Firing& firing, const LidarEcho& echo, double bias_m, double deviation) const {
    Slot slot;
    double range = echo.range_m;
    if (options_.noise) {
      const double dim = model_.dim_reflectivity > 0.0
                             ? std::max(0.0, 1.0 - echo.reflectivity / model_.dim_reflectivity)
                             : 0.0;
      const double sigma =
          model_.range_sigma_m + dim * std::max(0.0, model_.dim_sigma_m - model_.range_sigma_m);
      range += bias_m + dim * model_.dim_bias_m + sigma * deviation;
    }
    const bool steps = options_.quantisation && model_.range_step_m > 0.0;
    if (steps) range = model_.range_step_m * std::round(range / model_.range_step_m);
    if (range < model_.min_range_m || range > model_.max_range_m) return slot;
    const double intensity =
        std::min(model_.intensity_max, model_.intensity_scale * echo.reflectivity);
    slot.intensity = static_cast<float>(options_.quantisation ? std::round(intensity) : intensity);
    slot.point_in_lidar = firing.ray.origin + range * firing.ray.direction;
    slot.time_s = firing.time_s;
    slot.echo = echo;
    return slot;
  }

  const LidarModel& model_;
  const ScanOptions& options_;
  const LidarBeams& beams_;
  double start_azimuth_rad_ = 0.0;
  std::vector<double> biases_m_;
};

SimulatedScan Collect(const std::vector<Slot>& slots, int beams, bool with_rings, bool with_truth) {
  SimulatedScan scan;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const Slot& slot = slots[i];
    if (!slot.echo) continue;
    scan.cloud.points.push_back(slot.point_in_lidar);
    scan.cloud.intensity.push_back(slot.intensity);
    scan.cloud.time_s.push_back(slot.time_s);
    if (with_rings) {
      const std::size_t ring = i % static_cast<std::size_t>(beams);
      scan.cloud.ring.push_back(static_cast<std::uint16_t>(ring));
    }
    if (with_truth) scan.truth.push_back(slot.echo->truth);
  }
  return scan;
}

}  // namespace

Expected<SimulatedScan> SimulateScan(const Scene& scene, const LidarModel& model,
                                     const ScanOptions& options) {
  SEXTANT_RETURN_IF_ERROR(ValidateLidarModel(model));
  LidarSpot spot;
  if (options.divergence) {
    spot = {.aperture_h_m = model.aperture_h_m,
            .aperture_v_m = model.aperture_v_m,
            .divergence_h_rad = model.divergence_h_rad,
            .divergence_v_rad = model.divergence_v_rad};
  }
  SEXTANT_ASSIGN_OR_RETURN(const LidarBeams beams,
                           LidarBeams::Make(scene, spot, model.pulse_length_m));
  const Scanner scanner(model, options, beams);
  const int columns = ColumnCount(model);
  const int per_column = scanner.Beams();
  std::vector<Slot> slots(static_cast<std::size_t>(columns) * static_cast<std::size_t>(per_column));
  // Each column is seeded by its number, so the result does not depend on the threads.
  tbb::parallel_for(
      tbb::blocked_range<int>(0, columns, 16), [&](const tbb::blocked_range<int>& range) {
        LidarBeams::Scratch scratch;
        for (int column = range.begin(); column < range.end(); ++column) {
          scanner.ScanColumn(column, scratch,
                             slots.data() + static_cast<std::ptrdiff_t>(column) * per_column);
        }
      });
  return Collect(slots, per_column, !model.rosette.has_value(), options.truth);
}

}  // namespace sextant
