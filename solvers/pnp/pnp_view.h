// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "base/error.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// Projects unit rays onto the image plane of a view that contains them all: (x/z, y/z) in a camera
/// that is turned onto their mean where one of them is near or beyond 90 deg from the axis. Returns
/// the rotation of that view in the camera frame. Error: kInvalidInput where they span more than
/// 168 deg.
Expected<Eigen::Quaterniond> ProjectRays(std::span<const Eigen::Vector3d> rays,
                                         std::span<Eigen::Vector2d> image_points);

/// The input of the algebraic solvers, and the rotation from its view to the camera.
struct PnpView {
  Eigen::Quaterniond cam_from_view = Eigen::Quaterniond::Identity();
  std::vector<Eigen::Vector2d> image_points = {};
  std::vector<Eigen::Vector3d> points = {};
};

/// Errors: kInvalidInput where no ray of the camera model meets a pixel, and that of ProjectRays.
Expected<PnpView> MakeView(const Camera& camera, std::span<const Pair2d3d> pairs);

}  // namespace sextant
