// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "geometry/camera.h"

namespace sextant {

/// Reads intrinsics from a file of any of these formats; pixel (0, 0) is the centre of the top-left
/// pixel in all of them. Other keys are ignored.
/// - ROS camera_info YAML: K (or k, or camera_matrix: {rows, cols, data}) of 9 numbers, D (or d, or
///   distortion_coefficients), distortion_model plumb_bob | rational_polynomial | fisheye |
///   equidistant, width and height (or image_width and image_height); also omnidirectional with the
///   key xi, and double_sphere with xi and alpha.
/// - OpenCV FileStorage YAML: camera_matrix, distortion_coefficients, image_width, image_height.
/// - flat YAML: fx, fy, cx, cy, k1, k2, p1, p2, k3.
/// - a problem file of this project: its map `camera`.
/// - the INI form of ROS that the original package uses: sections [image] and [camera], with
///   width, height, camera matrix, distortion; rectification and projection are ignored.
/// Errors: kIo; kParse; kNonFinite; kInvalidInput (also for distortion models that Camera does not
/// have).
Expected<Camera> ReadCamera(const std::filesystem::path& path);
Expected<Camera> ParseCamera(std::string_view text, const std::string& file);

/// Formats the ROS calibration YAML of a camera; ParseCamera reads it back to the same bits. The
/// model is plumb_bob, rational_polynomial (with up to 14 coefficients), equidistant,
/// omnidirectional or double_sphere, the rectification the identity, and the projection K.
std::string FormatCameraInfo(const Camera& camera, const std::string& name);

Expected<Camera> ParseCameraYaml(std::string_view text, const std::string& file);
Expected<Camera> ParseCameraIni(std::string_view text, const std::string& file);

}  // namespace sextant
