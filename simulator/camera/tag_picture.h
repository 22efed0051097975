// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

#include "base/error.h"
#include "geometry/board.h"
#include "geometry/camera.h"
#include "geometry/rigid3d.h"
#include "simulator/camera/render.h"

namespace sextant {

/// One tag on a white board before a grey background: what studies of detectors are made of.
struct TagPictureOptions {
  std::string family = "aruco_original";
  int id = 26;
  double edge_m = 0.205;
  double side_px = 100.0;  ///< Of the reported square, were it to face the image's centre squarely.
  double tilt_rad = 0.0;   ///< Between the board's normal and the line of sight, below 90 degrees.
  std::string camera_model = "zed_left";
  double field = 0.6;      ///< Share of the image, each way, that the tag's centre is drawn from.
  std::uint64_t seed = 1;  ///< Of place, roll and direction of the tilt; the noise has its own.
  ImageOptions image{};
};

/// A window of the camera's image around the board: pixels are the whole image's, but for
/// vignetting, and `camera` is the window's.
struct TagPicture {
  cv::Mat image;  ///< CV_8U.
  Camera camera;
  Board board;
  Rigid3d cam_from_board;
  std::array<Eigen::Vector2d, 4> corners_px;  ///< Reported ones, clockwise from the tag's top-left.
};

/// Place uniform over the field, roll and the tilt's direction uniform over the circle.
/// Errors: kInvalidInput for a side or tilt out of range and for a board that the image does not
/// hold; those of FindCameraModel, RenderImage.
Expected<TagPicture> RenderTagPicture(const TagPictureOptions& options);

}  // namespace sextant
