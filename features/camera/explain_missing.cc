// SPDX-License-Identifier: Apache-2.0
#include "features/camera/explain_missing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "features/camera/tag_detector.h"
#include "features/camera/tag_reading.h"
#include "features/camera/tags/tag_pattern.h"
#include "geometry/board_check.h"

namespace sextant {
namespace {

constexpr double kSmallest_px = 16.0;
constexpr double kMinVisible_grey = 2.0;
constexpr double kMaxWrongShare = 0.1;
constexpr double kMaxPixelsToEnlarge = 6e6;

double MeanSide(const Quad& quad) {
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) sum += (quad[(k + 1) % 4] - quad[k]).norm();
  return 0.25 * sum;
}

bool IsIn(const cv::Mat& grey, const Eigen::Vector2d& pixel) {
  return pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < grey.cols - 0.5 &&
         pixel.y() < grey.rows - 0.5;
}

MissingTag FromPose(const cv::Mat& grey, const BoardTag& tag, const Camera& camera,
                    const BoardPose& pose) {
  Quad corners;
  const std::array<Eigen::Vector2d, 4> in_board = TagCorners(tag);
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d point(in_board[k].x(), in_board[k].y(), 0.0);
    const std::optional<Eigen::Vector2d> pixel = Project(camera, pose.cam_from_board * point);
    if (!pixel || !IsIn(grey, *pixel)) {
      return {MissingCause::kOutsideImage, "it is cut off by the image's border"};
    }
    corners[k] = *pixel;
  }
  if (const double side_px = MeanSide(corners); side_px < kSmallest_px) {
    return {MissingCause::kTooSmall,
            fmt::format("too small: {:.0f} px per side; move closer or use a larger tag", side_px)};
  }
  const TagPattern pattern = *MakeTagPattern(tag.family, tag.id);
  const TagReading reading = ReadTag(grey, corners, pattern);
  const int cells = (pattern.edge_cells - 2) * (pattern.edge_cells - 2);
  if (reading.margin > kMinVisible_grey && reading.wrong_cells <= kMaxWrongShare * cells) {
    return {MissingCause::kOverlooked,
            fmt::format("it is where the board's other tags predict it, and {} of its {} cells are "
                        "read correctly, by {:.0f} grey levels, but the detector missed it: its "
                        "border or margin may be hidden, or the contrast too low; try another "
                        "--detector or other options of it",
                        cells - reading.wrong_cells, cells, reading.margin)};
  }
  return {MissingCause::kCovered,
          fmt::format("where the board's other tags predict it, {} of its {} cells are read "
                      "wrongly: it is covered, too dark, or another tag was printed",
                      reading.wrong_cells, cells)};
}

// Reliable tags of a family in an image, by its default detector.
std::vector<TagDetection> ReliableTags(const std::string& family, const cv::Mat& grey) {
  const Expected<Detections> found =
      DetectorSpecFor(family)
          .and_then([](const std::string& spec) { return MakeTagDetector(spec); })
          .and_then([&grey](const TagDetectorPtr& detector) { return detector->Detect(grey); });
  if (!found) return {};
  std::vector<TagDetection> reliable = found->tags;
  std::erase_if(reliable,
                [](const TagDetection& tag) { return tag.decision_margin <= kReliableMargin; });
  return reliable;
}

cv::Mat Mirrored(const cv::Mat& grey) {
  cv::Mat mirrored;
  cv::flip(grey, mirrored, 1);
  return mirrored;
}

cv::Mat Enlarged(const cv::Mat& grey) {
  cv::Mat enlarged;
  cv::resize(grey, enlarged, {}, 2.0, 2.0, cv::INTER_CUBIC);
  return enlarged;
}

cv::Mat Sharpened(const cv::Mat& grey) {
  constexpr double kSigma_px = 3.0;
  constexpr double kAmount = 3.0;
  cv::Mat soft;
  cv::GaussianBlur(grey, soft, {}, kSigma_px);
  cv::Mat sharp;
  cv::addWeighted(grey, 1.0 + kAmount, soft, -kAmount, 0.0, sharp);
  return sharp;
}

MissingTag ByTrial(TagTrials& trials, const BoardTag& tag) {
  if (trials.InMirrorImage(tag)) {
    return {MissingCause::kMirrored,
            "its mirror image is there: the tag was printed mirrored, or the image is flipped"};
  }
  if (const auto found = trials.InEnlarged(tag)) {
    return {MissingCause::kTooSmall,
            fmt::format("too small: {:.0f} px per side; it is found in the image enlarged twice",
                        0.5 * MeanSide(found->corners_px))};
  }
  if (trials.InSharpened(tag)) {
    return {MissingCause::kBlurred, "blurred: it is found in the sharpened image"};
  }
  const std::vector<FamilyMatch> others = trials.InOtherFamilies(tag);
  if (!others.empty()) {
    return {MissingCause::kOtherFamily,
            fmt::format("there is no tag of {}, but there are tags of {}: {}", tag.family,
                        others[0].family, fmt::join(others[0].ids, ", "))};
  }
  return {MissingCause::kNotThere,
          "not seen, and not in the enlarged, sharpened or mirrored image either"};
}

}  // namespace

std::optional<TagDetection> TagTrials::FindIn(ByFamily& found, const BoardTag& tag,
                                              cv::Mat (*modify)(const cv::Mat&)) const {
  auto tags = found.find(tag.family);
  if (tags == found.end()) {
    tags = found.emplace(tag.family, ReliableTags(tag.family, modify(grey_))).first;
  }
  const auto it = std::ranges::find(tags->second, tag.id, &TagDetection::id);
  if (it == tags->second.end()) return std::nullopt;
  return *it;
}

std::optional<TagDetection> TagTrials::InMirrorImage(const BoardTag& tag) {
  return FindIn(mirrored_, tag, Mirrored);
}

std::optional<TagDetection> TagTrials::InEnlarged(const BoardTag& tag) {
  if (static_cast<double>(grey_.total()) >= kMaxPixelsToEnlarge) return std::nullopt;
  return FindIn(enlarged_, tag, Enlarged);
}

std::optional<TagDetection> TagTrials::InSharpened(const BoardTag& tag) {
  return FindIn(sharpened_, tag, Sharpened);
}

std::vector<FamilyMatch> TagTrials::InOtherFamilies(const BoardTag& tag) {
  if (!families_) families_ = FindFamilies(grey_);
  return OtherFamilies(*families_, tag.family, std::array{tag.id});
}

std::string_view ToString(MissingCause cause) {
  switch (cause) {
    case MissingCause::kOutsideImage:
      return "outside_image";
    case MissingCause::kTooSmall:
      return "too_small";
    case MissingCause::kBlurred:
      return "blurred";
    case MissingCause::kMirrored:
      return "mirrored";
    case MissingCause::kOtherFamily:
      return "other_family";
    case MissingCause::kCovered:
      return "covered";
    case MissingCause::kOverlooked:
      return "overlooked";
    case MissingCause::kNotThere:
      return "not_there";
  }
  return "unknown";
}

MissingTag ExplainMissing(TagTrials& trials, const BoardTag& tag, const Camera* camera,
                          const BoardPose* pose) {
  return camera != nullptr && pose != nullptr ? FromPose(trials.grey(), tag, *camera, *pose)
                                              : ByTrial(trials, tag);
}

}  // namespace sextant
