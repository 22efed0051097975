// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "geometry/camera.h"

namespace sextant {

/// Intrinsics from any of these files; pixel (0, 0) is the centre of the top-left pixel in all of
/// them. Keys beside those below are left alone.
/// - ROS camera_info YAML: K (or k, or camera_matrix: {rows, cols, data}) of 9 numbers, D (or d, or
///   distortion_coefficients), distortion_model plumb_bob | rational_polynomial | fisheye |
///   equidistant, width and height (or image_width and image_height).
/// - OpenCV FileStorage YAML: camera_matrix, distortion_coefficients, image_width, image_height.
/// - flat YAML: fx, fy, cx, cy, k1, k2, p1, p2, k3.
/// - a problem file of this project: its block `camera`.
/// - the INI form of ROS that the original package uses: sections [image] and [camera], then
///   width, height, camera matrix, distortion; rectification and projection are read over.
/// Errors: kIo; kParse (also skew, and distortion models that Camera does not have); kNonFinite;
/// kInvalidInput.
Expected<Camera> ReadCamera(const std::filesystem::path& path);
Expected<Camera> ParseCamera(std::string_view text, const std::string& file);

/// The ROS calibration YAML of a camera that it reads back to the bit: plumb_bob,
/// rational_polynomial or equidistant, an identity for the rectification, and K as the projection.
std::string FormatCameraInfo(const Camera& camera, const std::string& name);

Expected<Camera> ParseCameraYaml(std::string_view text, const std::string& file);
Expected<Camera> ParseCameraIni(std::string_view text, const std::string& file);

}  // namespace sextant
