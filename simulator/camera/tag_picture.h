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

/// One tag on a white board in front of a grey background, for studies of detectors.
struct TagPictureOptions {
  std::string family = "aruco_original";
  int id = 26;
  double edge_m = 0.205;
  /// Side of the reported square if it faced the camera at the image centre.
  double side_px = 100.0;
  double tilt_rad = 0.0;  ///< Between the board's normal and the line of sight, below 90 degrees.
  std::string camera_model = "zed_left";
  /// Fraction of the image in each direction from which the tag's centre is drawn.
  double field = 0.6;
  /// Seed of position, roll and tilt direction; the noise has its own seed.
  std::uint64_t seed = 1;
  ImageOptions image{};
};

/// A window of the camera's image around the board. Its pixels equal those of the whole image
/// except for vignetting; `camera` is the camera of the window.
struct TagPicture {
  cv::Mat image;  ///< CV_8U.
  Camera camera;
  Board board;
  Rigid3d cam_from_board;
  /// True positions of the reported corners, clockwise from the tag's top-left.
  std::array<Eigen::Vector2d, 4> corners_px;
};

/// Renders a tag at a position drawn uniformly from the field, with roll and tilt direction uniform
/// over the circle. Errors: kInvalidInput for a side or tilt out of range and for a board that is
/// not completely in the image; those of FindCameraModel and RenderImage.
Expected<TagPicture> RenderTagPicture(const TagPictureOptions& options);

}  // namespace sextant
