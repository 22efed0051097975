// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "geometry/camera.h"

namespace sextant {

/// Reads intrinsics from a file of any of these programs; pixel (0, 0) is the centre of the
/// top-left pixel in all of them. Other keys are ignored.
/// - ROS camera_info YAML: K (or k, or camera_matrix: {rows, cols, data}) of 9 numbers, D (or d, or
///   distortion_coefficients), distortion_model plumb_bob | rational_polynomial | fisheye |
///   equidistant, width and height (or image_width and image_height); also omnidirectional with the
///   key xi, and double_sphere with xi and alpha.
/// - OpenCV FileStorage, YAML or XML: camera_matrix or cameraMatrix, distortion_coefficients,
///   distCoeffs or dist_coeffs, image_width, image_height; fisheye_model: 1 of its sample.
/// - flat YAML: fx, fy, cx, cy, k1, k2, p1, p2, k3 to k6, also with the prefixes and underscores of
///   FAST-LIVO (cam_fx, cam_d0), ORB-SLAM (Camera.fx) and others (f_x, k_1), and within other maps.
/// - Kalibr's camchain: camera_model, intrinsics, distortion_model, distortion_coeffs, resolution.
/// - camodocal: model_type PINHOLE | MEI | KANNALA_BRANDT with its groups of parameters.
/// - any of these with K as fx, fy, cx, cy.
/// - SensorsCalibration (OpenCalib) JSON: cam_K, cam_dist, img_dist_w, img_dist_h.
/// - KITTI's calibration: P0 to P3 or P_rect_00 to P_rect_03 (K alone; their offset is ignored).
/// - a problem file of this project: its map `camera`.
/// - the INI form of ROS that the original package uses: sections [image] and [camera], with
///   width, height, camera matrix, distortion; rectification and projection are ignored. Livox's
///   form without sections: intrinsic, distortion.
/// `name` chooses one of several cameras of a file (cam0, P2); ReadCamera takes it from the path,
/// as in chain.yaml:cam0.
/// Cost: time and memory are those of ParseYaml; XML is read up to 1 MiB.
/// Errors: kIo; kParse, also for a file of several cameras without a name; kNonFinite;
/// kInvalidInput (also for models that Camera does not have).
Expected<Camera> ReadCamera(const std::filesystem::path& path);
Expected<Camera> ParseCamera(std::string_view text, const std::string& file);
Expected<Camera> ParseNamedCamera(std::string_view text, const std::string& file,
                                  std::string_view name);

/// Formats the ROS calibration YAML of a camera; ParseCamera reads it back to the same bits. The
/// model is plumb_bob, rational_polynomial (with up to 14 coefficients), equidistant,
/// omnidirectional or double_sphere, the rectification the identity, and the projection K.
std::string FormatCameraInfo(const Camera& camera, const std::string& name);

Expected<Camera> ParseCameraYaml(std::string_view text, const std::string& file,
                                 std::string_view name);
Expected<Camera> ParseCameraIni(std::string_view text, const std::string& file);

}  // namespace sextant
