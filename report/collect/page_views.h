// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calibrate/calibrate.h"
#include "geometry/camera.h"
#include "io/results/calibration_result.h"
#include "report/collect/frame_source.h"
#include "report/page/page.h"

namespace sextant {

/// A camera with its facts and its frustum, without a pose.
PageSensor PageCameraOf(const std::string& name, const Camera& camera);

/// The camera and the LiDAR, with the camera's pose in the LiDAR frame.
std::vector<PageSensor> PageSensorsOf(const CalibrationResult& result);

/// Every view with its boards, its photo and its scan; or why it has none. A result file has no
/// boards of the views that were left out: those that each sensor saw come from the calibration,
/// which may be null, as does the reason why a board of a kept view was left out.
std::vector<PageView> PageViewsOf(const CalibrationResult& result, const Calibration* calibration,
                                  const FrameSource& frames);

/// Outline of a board in the image, with the lens: closed, in pieces. Empty where a part of it does
/// not project.
std::vector<Eigen::Vector2d> OutlineInImage(const Camera& camera, const Board& board,
                                            const Rigid3d& cam_from_board);

}  // namespace sextant
