// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "features/camera/board_pose.h"
#include "features/camera/detection.h"

namespace sextant {

enum class MissingCause {
  kOutsideImage,  ///< According to the board's pose, a corner of the tag is outside the image.
  kTooSmall,      ///< Found in the image enlarged twice, or under 16 px according to the pose.
  kBlurred,       ///< Found in the sharpened image.
  kMirrored,      ///< Found in the mirror image.
  kOtherFamily,   ///< Tags of another family were found instead.
  kCovered,       ///< Its cells cannot be read at its position according to the pose.
  kOverlooked,    ///< Its cells can be read at that position, but the detector missed the tag.
  kNotThere,      ///< None of these.
};
std::string_view ToString(MissingCause cause);

struct MissingTag {
  MissingCause cause = MissingCause::kNotThere;
  std::string text{};  ///< One line for people, with figures.
};

/// Explains why a tag of a board was not found: from the board's pose if its other tags gave one,
/// else by searching modified images. Slow (up to a second per megapixel).
MissingTag ExplainMissing(const cv::Mat& grey, const BoardTag& tag, const Camera* camera,
                          const BoardPose* pose);

/// The tags of one family in an image.
struct FamilyMatch {
  std::string family{};
  std::vector<int> ids{};  ///< Ascending.
  int wanted = 0;          ///< How many of the wanted ids are among them.
};

/// Every family except `except` with tags in the image that are read without a wrong cell, ordered
/// by the number of wanted ids, then of tags, then of cells (tags with few cells are often false
/// detections). Dictionaries that share their first tags (4x4_50 and 4x4_1000) are all listed.
std::vector<FamilyMatch> FindOtherFamilies(const cv::Mat& grey, const std::string& except,
                                           std::span<const int> wanted_ids);

}  // namespace sextant
