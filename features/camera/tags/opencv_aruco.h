// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#if CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR < 7
#include <opencv2/aruco.hpp>
#else
#include <opencv2/objdetect/aruco_detector.hpp>
#endif

namespace sextant {

// ArUco moved from the contributed module `aruco` to `objdetect` with OpenCV 4.7, and its functions
// changed with it. All differences between the two are in this file and its source.

/// A tag of the dictionary and its corners [px], clockwise from the tag's own top left, with
/// OpenCV's own offsets (see aruco_detector.h).
struct OpenCvTag {
  int id = -1;
  std::array<cv::Point2f, 4> corners_px;
};

/// `type` is one of OpenCV's enumerators, such as cv::aruco::DICT_6X6_250.
cv::aruco::Dictionary PredefinedArucoDictionary(int type);

/// OpenCV's defaults, with those of OpenCV 4.6 where later versions have another one that changes
/// corners: the window of the subpixel refinement does not depend on the size of the tag's cells.
cv::aruco::DetectorParameters ArucoParameters();

/// `image` is of 8 bits, grey or colour.
std::vector<OpenCvTag> DetectAruco(const cv::Mat& image, const cv::aruco::Dictionary& dictionary,
                                   const cv::aruco::DetectorParameters& parameters);

/// The tag as it is printed, with a black border and one pixel per cell.
cv::Mat DrawArucoCells(const cv::aruco::Dictionary& dictionary, int id, int border_cells = 1);

}  // namespace sextant
