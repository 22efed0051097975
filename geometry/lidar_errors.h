// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace sextant {

/// The systematic errors of a LiDAR, which all views share or which all returns of one view share:
/// standard deviations of their priors. Zero: the sensor has no such error. The white noise of
/// ranges and edges is stated by each view. Defaults: a sensor about which nothing is known.
struct LidarErrorModel {
  /// Standard deviation of a constant that one ring adds to every range; for returns with a ring
  /// number.
  double ring_offset_sigma_m = 0.010;
  /// Standard deviation of a constant that the sensor adds to every range.
  double range_offset_sigma_m = 0.010;
  /// Standard deviation of the distance by which an outline appears too far out, for edges along
  /// the scan direction and across it. Extractors have corrected its expected value.
  double edge_growth_sigma_m = 0.003;
  /// Expected shift, along each axis, of all returns of one board in one view together, from a
  /// board that is not flat or not still and returns that are not independent. Estimated from the
  /// views; this value counts like a few views.
  double view_shift_sigma_m = 0.001;

  friend bool operator==(const LidarErrorModel&, const LidarErrorModel&) = default;
};

/// A sensor whose errors are all independent.
inline constexpr LidarErrorModel kWhiteNoiseOnly{0.0, 0.0, 0.0, 0.0};

}  // namespace sextant
