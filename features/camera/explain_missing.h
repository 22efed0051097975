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
  kOutsideImage,  ///< The board's pose puts a corner of it outside.
  kTooSmall,      ///< It is found in the image enlarged twice, or is under 16 px by the pose.
  kBlurred,       ///< It is found in the image sharpened.
  kMirrored,      ///< It is found in the image's mirror image.
  kOtherFamily,   ///< Tags of another family are there instead.
  kCovered,       ///< Where the pose puts it, its cells are not to be read.
  kOverlooked,    ///< Where the pose puts it, it is to be read, yet the detector did not.
  kNotThere,      ///< None of these.
};
std::string_view ToString(MissingCause cause);

struct MissingTag {
  MissingCause cause = MissingCause::kNotThere;
  std::string text{};  ///< One line for people, with figures.
};

/// Why a tag of a board was not found: from the board's pose, where its other tags gave one, else
/// by trying what would make it visible. Slow (up to a second a megapixel), for when it is needed.
MissingTag ExplainMissing(const cv::Mat& grey, const BoardTag& tag, const Camera* camera,
                          const BoardPose* pose);

/// Tags of one family that an image shows.
struct FamilyMatch {
  std::string family{};
  std::vector<int> ids{};  ///< Ascending.
  int wanted = 0;          ///< How many of them were looked for.
};

/// Every family but `except` with tags in the image that are read without a wrong cell; those with
/// most of the wanted ids first, then with most tags, then with most cells (small ones are read
/// into anything). Of dictionaries that begin alike (4x4_50 and 4x4_1000) each is listed.
std::vector<FamilyMatch> FindOtherFamilies(const cv::Mat& grey, const std::string& except,
                                           std::span<const int> wanted_ids);

}  // namespace sextant
