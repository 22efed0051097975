// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

namespace sextant {

/// The tags of one family in an image.
struct FamilyMatch {
  std::string family{};
  std::vector<int> ids{};  ///< Ascending.
  int wanted = 0;          ///< How many of the wanted ids are among them.
};

/// Every family with tags in the image that are read without a wrong cell, with a margin above
/// kReliableMargin, by the family's default detector. Dictionaries that share their first tags
/// (4x4_50 and 4x4_1000) are all listed. The image is reduced to 1600 px. It is searched once for
/// each size of OpenCV's dictionaries, in the largest one, and once for all families of AprilTag's
/// library, in parallel: 11 searches for 31 families, which bounds the time for cluttered images.
std::vector<FamilyMatch> FindFamilies(const cv::Mat& grey);

/// The families except `except`, ordered by the number of wanted ids, then of tags, then of cells
/// (tags with few cells are often false detections).
std::vector<FamilyMatch> OtherFamilies(std::vector<FamilyMatch> families, const std::string& except,
                                       std::span<const int> wanted_ids);

/// Tags with a lower margin are not relied on where many images or families are searched.
inline constexpr double kReliableMargin = 20.0;

}  // namespace sextant
