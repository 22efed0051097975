// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string_view>

#include "geometry/camera.h"

namespace sextant {

/// The intrinsics of a camera that can be estimated, in one vector: fx, fy, cx, cy [px], then the
/// first eight of Camera::distortion. Skew, thin prism, tilt, xi and alpha stay as given.
inline constexpr int kIntrinsicCount = 12;
inline constexpr int kFirstDistortion = 4;
using IntrinsicVector = Eigen::Matrix<double, kIntrinsicCount, 1>;

IntrinsicVector IntrinsicsOf(const Camera& camera);

/// `camera` with these intrinsics in place of its own; not validated.
Camera WithIntrinsics(const Camera& camera, const IntrinsicVector& numbers);

/// `camera` for images of this size in place of its own; not validated.
Camera WithImageSize(const Camera& camera, int width_px, int height_px);

/// The coefficients that files have: the first eight, or all where one of the others is not zero.
std::span<const double> WrittenDistortion(const Camera& camera);

/// The name of intrinsic `index` in that model: "fx_px", ..., "k1", "p1" and so on.
std::string_view IntrinsicName(CameraModel model, int index);

/// Derivative by the intrinsics of the pixel that Project returns; none where that returns none.
/// Zero for the distortion of a pinhole.
std::optional<Eigen::Matrix<double, 2, kIntrinsicCount>> PixelByIntrinsics(
    const Camera& camera, const Eigen::Vector3d& point_in_cam);

}  // namespace sextant
