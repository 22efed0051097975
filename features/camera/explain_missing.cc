// SPDX-License-Identifier: Apache-2.0
#include "features/camera/explain_missing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "features/camera/tag_detector.h"
#include "features/camera/tag_reading.h"
#include "features/camera/tags/tag_pattern.h"
#include "geometry/board_check.h"

namespace sextant {
namespace {

constexpr double kSmallest_px = 16.0;
constexpr double kMinMargin = 20.0;
constexpr double kMinVisible_grey = 2.0;
constexpr double kMaxWrongShare = 0.1;
constexpr int kMaxSideForTrials_px = 1600;
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
                [](const TagDetection& tag) { return tag.decision_margin <= kMinMargin; });
  return reliable;
}

// The tag in a modified image.
std::optional<TagDetection> FindIn(const cv::Mat& grey, const BoardTag& tag) {
  const std::vector<TagDetection> tags = ReliableTags(tag.family, grey);
  const auto found = std::ranges::find(tags, tag.id, &TagDetection::id);
  if (found == tags.end()) return std::nullopt;
  return *found;
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

MissingTag ByTrial(const cv::Mat& grey, const BoardTag& tag) {
  cv::Mat changed;
  cv::flip(grey, changed, 1);
  if (FindIn(changed, tag)) {
    return {MissingCause::kMirrored,
            "its mirror image is there: the tag was printed mirrored, or the image is flipped"};
  }
  if (static_cast<double>(grey.total()) < kMaxPixelsToEnlarge) {
    cv::resize(grey, changed, {}, 2.0, 2.0, cv::INTER_CUBIC);
    if (const auto found = FindIn(changed, tag)) {
      return {MissingCause::kTooSmall,
              fmt::format("too small: {:.0f} px per side; it is found in the image enlarged twice",
                          0.5 * MeanSide(found->corners_px))};
    }
  }
  if (FindIn(Sharpened(grey), tag)) {
    return {MissingCause::kBlurred, "blurred: it is found in the sharpened image"};
  }
  const std::array wanted = {tag.id};
  const std::vector<FamilyMatch> others = FindOtherFamilies(grey, tag.family, wanted);
  if (!others.empty()) {
    return {MissingCause::kOtherFamily,
            fmt::format("there is no tag of {}, but there are tags of {}: {}", tag.family,
                        others[0].family, fmt::join(others[0].ids, ", "))};
  }
  return {MissingCause::kNotThere,
          "not seen, and not in the enlarged, sharpened or mirrored image either"};
}

std::vector<int> ReliableIds(const std::string& family, const cv::Mat& grey) {
  std::vector<int> ids;
  for (const TagDetection& tag : ReliableTags(family, grey)) {
    if (tag.hamming == 0) ids.push_back(tag.id);
  }
  std::ranges::sort(ids);
  return ids;
}

int CellsOf(const std::string& family) { return MakeTagPattern(family, 0)->cells; }

}  // namespace

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

MissingTag ExplainMissing(const cv::Mat& grey, const BoardTag& tag, const Camera* camera,
                          const BoardPose* pose) {
  return camera != nullptr && pose != nullptr ? FromPose(grey, tag, *camera, *pose)
                                              : ByTrial(grey, tag);
}

std::vector<FamilyMatch> FindOtherFamilies(const cv::Mat& grey, const std::string& except,
                                           std::span<const int> wanted_ids) {
  cv::Mat small = grey;
  const int side = std::max(grey.cols, grey.rows);
  if (side > kMaxSideForTrials_px) {
    const double scale = static_cast<double>(kMaxSideForTrials_px) / side;
    cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
  }
  std::vector<FamilyMatch> matches;
  for (const std::string& family : TagFamilies()) {
    if (family == except) continue;
    FamilyMatch match{.family = family, .ids = ReliableIds(family, small)};
    for (const int id : match.ids) {
      match.wanted += std::ranges::count(wanted_ids, id) > 0 ? 1 : 0;
    }
    if (!match.ids.empty()) matches.push_back(std::move(match));
  }
  std::ranges::stable_sort(matches, [](const FamilyMatch& a, const FamilyMatch& b) {
    return std::tuple(a.wanted, a.ids.size(), CellsOf(a.family)) >
           std::tuple(b.wanted, b.ids.size(), CellsOf(b.family));
  });
  return matches;
}

}  // namespace sextant
