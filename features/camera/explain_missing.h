// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "features/camera/board_pose.h"
#include "features/camera/detection.h"
#include "features/camera/find_families.h"

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

/// The tags in modified images, each searched once for a family, when first asked for.
class TagTrials {
 public:
  explicit TagTrials(cv::Mat grey) : grey_(std::move(grey)) {}

  const cv::Mat& grey() const { return grey_; }

  /// The tag in the mirror image, in the image enlarged twice (only below 6 megapixels), and in the
  /// sharpened image; none if it is not reliably there.
  std::optional<TagDetection> InMirrorImage(const BoardTag& tag);
  std::optional<TagDetection> InEnlarged(const BoardTag& tag);
  std::optional<TagDetection> InSharpened(const BoardTag& tag);
  /// Tags of other families in the image; see OtherFamilies.
  std::vector<FamilyMatch> InOtherFamilies(const BoardTag& tag);

 private:
  using ByFamily = std::map<std::string, std::vector<TagDetection>>;
  std::optional<TagDetection> FindIn(ByFamily& found, const BoardTag& tag,
                                     cv::Mat (*modify)(const cv::Mat&)) const;

  cv::Mat grey_;
  ByFamily mirrored_;
  ByFamily enlarged_;
  ByFamily sharpened_;
  std::optional<std::vector<FamilyMatch>> families_;
};

/// Explains why a tag of a board was not found: from the board's pose if its other tags gave one,
/// else by searching modified images. Slow (up to a second per megapixel), but once per image for
/// all tags of a family.
MissingTag ExplainMissing(TagTrials& trials, const BoardTag& tag, const Camera* camera,
                          const BoardPose* pose);

}  // namespace sextant
