// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "base/error.h"
#include "simulator/camera/lighting.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// Options of an image. By default it is sharp, without noise and without saturation.
struct ImageOptions {
  std::uint64_t seed = 0;  ///< Seed of the noise; different for every image of a session.
  double time_s = 0.0;  ///< Time after the session's start; determines the pose of swinging boards.
  double exposure = 1.0;            ///< Grey level = 255 x exposure x radiance; see Lighting.
  double blur_sigma_px = 0.0;       ///< Gaussian blur of the lens, in addition to the pixel area.
  double vignetting = 0.0;          ///< Fraction of the light lost in the farthest image corner.
  double noise_sigma_grey = 0.0;    ///< Normal noise of every pixel, in grey levels.
  double shot_variance_grey = 0.0;  ///< Shot noise: additional variance per grey level of light.
  /// If set (1 to 100), the image is compressed as JPEG and decompressed.
  std::optional<int> jpeg_quality{};
  Lighting lighting{};
};

/// Options of a typical camera: blur 0.7 px, noise of 2 grey levels plus shot noise, a quarter of
/// the light lost in the corners. A white board that faces the lamp is just below saturation.
ImageOptions UsualImageOptions(std::uint64_t seed, double time_s);

/// Renders the image of a scene's camera: 8-bit grey (CV_8U), linear in the light, each pixel being
/// the mean over its square. Pixel (0, 0) is the centre of the top-left pixel. The camera is
/// RenderingCamera() of simulator/scene/camera_model.h. Pixels where the lens has no image are
/// black.
///
/// Steps: radiance of surfaces (simulator/camera/area_sampler.h), blur, vignetting, exposure,
/// noise, rounding, JPEG. The same seed gives the same bytes on any number of threads.
///
/// Errors: kInvalidInput for a camera that the scene does not have and options out of range; those
/// of RenderingCamera() and CameraView::Make().
Expected<cv::Mat> RenderImage(const Scene& scene, int camera_index, const ImageOptions& options);

/// Depth and normal at the centre of each pixel, without noise.
struct SurfaceImage {
  cv::Mat depth_m;        ///< CV_64F, along the camera's z axis; 0 for the background.
  cv::Mat normal_in_cam;  ///< CV_64FC3, unit vector towards the camera; 0 for the background.
};

/// Renders depth and normals. Errors: as RenderImage.
Expected<SurfaceImage> RenderSurfaces(const Scene& scene, int camera_index, double time_s);

}  // namespace sextant
