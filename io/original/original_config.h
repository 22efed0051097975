// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The content of `config_file.txt` of the original package, in any of its historical variants.
struct OriginalConfig {
  int width_px = 0;
  int height_px = 0;
  std::array<double, 2> x_range_m{};  ///< Lower and upper limit of the LiDAR points that are kept.
  std::array<double, 2> y_range_m{};
  std::array<double, 2> z_range_m{};
  double intensity_threshold = 0.0;
  int markers = 0;
  bool use_camera_info = false;
  /// [K | t] of the camera, pixels.
  Eigen::Matrix<double, 3, 4> projection = Eigen::Matrix<double, 3, 4>::Zero();
  std::optional<int> max_iterations;
  /// Angles about x, y, z [rad]: R0 = Rz Ry Rx.
  std::optional<Eigen::Vector3d> initial_rotation_rad;
  std::optional<Eigen::Vector3d> initial_translation_m;
  std::optional<int> lidar_type;  ///< 0 Velodyne, 1 Hesai.

  /// The initial pose as a transform; absent parts are the identity. The package applies this
  /// rotation to the LiDAR points before it writes points.txt.
  Rigid3d InitialPose() const;
};

/// The variants are distinguished by the count of numbers: 23 (no initial pose), 27 (with
/// iterations and rotation), 28 (and LiDAR type), 30 (translation instead of the type), 31 (both).
/// Errors: kIo, kParse, kNonFinite, with file, line and name of the field.
/// Time is linear in the file's size, memory at most 20 times it.
Expected<OriginalConfig> ReadOriginalConfig(const std::filesystem::path& path);
Expected<OriginalConfig> ParseOriginalConfig(std::string_view text, const std::string& file);

}  // namespace sextant
