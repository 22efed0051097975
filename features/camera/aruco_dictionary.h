// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/aruco/dictionary.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sextant {

/// "aruco_original", "aruco_4x4_50" to "aruco_7x7_1000": OpenCV's predefined dictionaries.
const std::vector<std::string>& ArucoDictionaryNames();

/// None where OpenCV has none of that name. "aruco_tag36h11" and so on are AprilTag families that
/// OpenCV decodes itself.
std::optional<cv::Ptr<cv::aruco::Dictionary>> FindArucoDictionary(std::string_view name);

}  // namespace sextant
