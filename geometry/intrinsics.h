// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>

#include "geometry/camera.h"

namespace sextant {

/// The numbers of a camera in one vector: fx, fy, cx, cy [px], then the eight of
/// Camera::distortion.
inline constexpr int kIntrinsicCount = 12;
inline constexpr int kFirstDistortion = 4;
using IntrinsicVector = Eigen::Matrix<double, kIntrinsicCount, 1>;

IntrinsicVector IntrinsicsOf(const Camera& camera);

/// `camera` with these numbers in place of its own; not validated.
Camera WithIntrinsics(const Camera& camera, const IntrinsicVector& numbers);

/// "fx_px", ..., "k1", "p1" and so on: what number `index` is called in that model.
std::string_view IntrinsicName(CameraModel model, int index);

/// Derivative of the pixel by the numbers of the camera, for the point whose pixel Project gives;
/// none where that does. Zero by the distortion of a pinhole, which has none.
std::optional<Eigen::Matrix<double, 2, kIntrinsicCount>> PixelByIntrinsics(
    const Camera& camera, const Eigen::Vector3d& point_in_cam);

}  // namespace sextant
