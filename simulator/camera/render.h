// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "base/error.h"
#include "simulator/camera/lighting.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// How an image is taken. As it stands: sharp, without noise, all light in the range.
struct ImageOptions {
  std::uint64_t seed = 0;             ///< Of the noise; another for every image of a session.
  double time_s = 0.0;                ///< After the session's start: where swinging boards are.
  double exposure = 1.0;              ///< Grey level = 255 x exposure x radiance; see Lighting.
  double blur_sigma_px = 0.0;         ///< Gaussian, of the lens; the pixel's square comes besides.
  double vignetting = 0.0;            ///< Share of the light lost in the farthest image corner.
  double noise_sigma_grey = 0.0;      ///< Normal noise of every pixel, in grey levels.
  double shot_variance_grey = 0.0;    ///< Variance per grey level of light that comes on top.
  std::optional<int> jpeg_quality{};  ///< 1 to 100: through JPEG and back.
  Lighting lighting{};
};

/// What a usual camera gives: blur 0.7 px, noise 2 and shot noise, a quarter of the light lost in
/// the corners. A white board that squarely faces the lamp is just not saturated.
ImageOptions UsualImageOptions(std::uint64_t seed, double time_s);

/// The image of a scene's camera: 8-bit grey (CV_8U), linear in the light, each pixel the mean over
/// its square. Pixel (0, 0) is the centre of the top-left pixel. The camera is RenderingCamera()
/// of simulator/scene/camera_model.h. What lies where the lens has no image is black.
///
/// Order: light of surfaces (simulator/camera/area_sampler.h), blur, vignetting, exposure, noise,
/// rounding, JPEG. The same seed gives the same bytes on any number of threads.
///
/// Errors: kInvalidInput for a camera that the scene does not have, options out of their range,
/// and what RenderingCamera() and CameraView::Make() refuse.
Expected<cv::Mat> RenderImage(const Scene& scene, int camera_index, const ImageOptions& options);

/// What the pixels' centres see, without noise.
struct SurfaceImage {
  cv::Mat depth_m;        ///< CV_64F, along the camera's z; 0 where nothing is seen.
  cv::Mat normal_in_cam;  ///< CV_64FC3, unit, towards the camera; 0 where nothing is seen.
};

/// Errors: as RenderImage.
Expected<SurfaceImage> RenderSurfaces(const Scene& scene, int camera_index, double time_s);

}  // namespace sextant
