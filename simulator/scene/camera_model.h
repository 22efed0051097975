// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/camera.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// Names of the camera models for scenes:
/// - "pinhole": 1280 x 720, f 700 px, no distortion;
/// - "zed_left": the left camera of a Stereolabs ZED at HD720, the paper's camera: 1280 x 720,
///   f 700 px (2.8 mm at 4 um, data sheet), Brown-Conrady distortion of a typical calibration;
/// - "point_grey": a FLIR (Point Grey) Blackfly BFLY-PGE-13S2M, 1288 x 964 at 3.75 um (data
///   sheet), with a lens of 8 mm: f 2133 px. The paper's second camera, "Point Gray Black Fly
///   which has a very large focal length", is not specified further;
/// - "fisheye": 1920 x 1208, equidistant, the calibration that comes with the public data set of
///   acfr/cam_lidar_calibration.
const std::vector<std::string>& CameraModelNames();

/// Error: kUnknownName, with the nearest known name.
Expected<Camera> FindCameraModel(std::string_view name);

/// The camera that renders the images: the named model or, if none is named, the scene camera's own
/// intrinsics. Errors: those of FindCameraModel and ValidateCamera; kInvalidInput for an image
/// without a size or with more than 100 million pixels. Messages name the camera.
Expected<Camera> RenderingCamera(const SceneCamera& camera);

/// The camera that the calibration pipeline assumes: `assumed_intrinsics` if given, else
/// RenderingCamera.
Expected<Camera> PublishedCamera(const SceneCamera& camera);

/// The right camera of a stereo pair: like `left`, shifted by `baseline_m` along its x axis.
SceneCamera StereoPartner(const SceneCamera& left, double baseline_m, const std::string& name);

}  // namespace sextant
