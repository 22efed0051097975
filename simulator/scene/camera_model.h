// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/camera.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// Cameras that can be named in a scene:
/// - "pinhole": 1280 x 720, f 700 px, no distortion;
/// - "zed_left": as the left camera of a Stereolabs ZED at HD720, the paper's camera: 1280 x 720,
///   f 700 px (2.8 mm at 4 um, data sheet), Brown-Conrady of the usual size of its calibrations;
/// - "point_grey": as a FLIR (Point Grey) Blackfly BFLY-PGE-13S2M, 1288 x 964 at 3.75 um (data
///   sheet), with a lens of 8 mm: f 2133 px. The paper's second camera, "Point Gray Black Fly
///   which has a very large focal length", is not named closer than that;
/// - "fisheye": 1920 x 1208, equidistant, the calibration that comes with the public data set of
///   acfr/cam_lidar_calibration.
const std::vector<std::string>& CameraModelNames();

/// Error: kUnknownName, with the nearest known.
Expected<Camera> FindCameraModel(std::string_view name);

/// What renders a scene's camera: the named model or, where none is named, its own intrinsics.
/// Errors: those of FindCameraModel and ValidateCamera; kInvalidInput for an image without a size,
/// or of more than 100 million pixels. Messages name the camera.
Expected<Camera> RenderingCamera(const SceneCamera& camera);

/// What the pipeline is told that camera is: `assumed_intrinsics`, else as RenderingCamera.
Expected<Camera> PublishedCamera(const SceneCamera& camera);

/// The right camera of a stereo pair: like `left`, `baseline_m` along the left one's x axis.
SceneCamera StereoPartner(const SceneCamera& left, double baseline_m, const std::string& name);

}  // namespace sextant
