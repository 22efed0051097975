// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "features/camera/tags/opencv_aruco.h"
#include "features/camera/tags/tag_pattern.h"

namespace sextant {

/// "aruco_original", "aruco_4x4_50" to "aruco_7x7_1000": OpenCV's predefined dictionaries, and
/// "aruco_tag36h11_border2", the tags of Kalibr's AprilGrid, whose black border is two cells wide.
const std::vector<std::string>& ArucoDictionaryNames();

/// None if OpenCV has none of that name. "aruco_tag36h11" and so on are AprilTag families that
/// OpenCV decodes itself.
std::optional<cv::aruco::Dictionary> FindArucoDictionary(std::string_view name);

/// Width of the black border of that dictionary's tags, in cells.
int ArucoBorderCells(std::string_view name);

/// Reads a custom dictionary in OpenCV's format: nmarkers, markersize, marker_0: "0110..." and so
/// on (and maxCorrectionBits). Errors: kIo; kParse, also for a file above 16 MiB or one that nests
/// deeply. Time and memory are those of OpenCV's parser, linear in the size.
Expected<cv::aruco::Dictionary> ReadArucoDictionary(const std::string& path);

/// The printed pattern of an id of the dictionary: its bits with a black border.
TagPattern MakeArucoPattern(const cv::aruco::Dictionary& dictionary, int id, int border_cells = 1);

}  // namespace sextant
