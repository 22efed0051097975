// SPDX-License-Identifier: Apache-2.0
#include "features/camera/tag_detector.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <tuple>

#include "base/nearest_name.h"
#include "base/spec.h"
#include "features/camera/apriltag_detector.h"
#include "features/camera/aruco_detector.h"
#include "features/camera/checkerboard_detector.h"
#include "features/camera/grey_image.h"
#include "features/camera/tags/tag_pattern.h"

namespace sextant {
namespace {

Expected<void> CheckOptions(const TagDetectorEntry& entry, const OptionValues& options) {
  std::vector<std::string> known;
  for (const OptionDoc& doc : entry.options) known.push_back(doc.name);
  for (std::size_t i = 0; i < options.size(); ++i) {
    const std::string& name = options[i].first;
    if (std::ranges::count(known, name) == 0) {
      return MakeError(ErrorCode::kUnknownName,
                       fmt::format("detector '{}' has no option '{}'; {}", entry.name, name,
                                   SuggestName(name, known)));
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (options[j].first == name) {
        return MakeError(ErrorCode::kInvalidOption, fmt::format("detector '{}': option '{}' is "
                                                                "given twice",
                                                                entry.name, name));
      }
    }
  }
  return {};
}

void Sort(std::vector<TagDetection>& tags) {
  std::ranges::sort(tags, [](const TagDetection& a, const TagDetection& b) {
    return std::tie(a.family, a.id, a.corners_px[0].x(), a.corners_px[0].y()) <
           std::tie(b.family, b.id, b.corners_px[0].x(), b.corners_px[0].y());
  });
}

}  // namespace

Expected<Detections> TagDetector::Detect(const cv::Mat& image) const {
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat grey, ToGrey(image));
  try {
    Detections found = DoDetect(grey);
    Sort(found.tags);
    return found;
  } catch (const cv::Exception& error) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("{} refuses the image: {}", name_, error.err));
  }
}

const std::vector<TagDetectorEntry>& TagDetectorEntries() {
  static const std::vector<TagDetectorEntry> entries = {
      ArucoDetectorEntry(), AprilTagDetectorEntry(), CheckerboardDetectorEntry()};
  return entries;
}

Expected<TagDetectorPtr> MakeTagDetector(std::string_view spec) {
  SEXTANT_ASSIGN_OR_RETURN(const SpecNode node, ParseSpec(spec));
  std::vector<std::string> known;
  for (const TagDetectorEntry& entry : TagDetectorEntries()) {
    known.push_back(entry.name);
    if (entry.name != node.name) continue;
    if (!node.inner.empty()) {
      return MakeError(ErrorCode::kInvalidOption,
                       fmt::format("detector '{}' takes option=value in its parentheses, got '{}'; "
                                   "write {}",
                                   entry.name, node.inner.front().name, entry.example));
    }
    SEXTANT_RETURN_IF_ERROR(CheckOptions(entry, node.options));
    return entry.make(FormatSpec(node), node.options);
  }
  const Expected<std::string> of_family = DetectorSpecFor(node.name);
  const std::string nearest = of_family ? *of_family : NearestName(node.name, known);
  return MakeError(
      ErrorCode::kUnknownName,
      fmt::format("unknown detector '{}'; {}expected {}, with options as in sextant list detectors",
                  node.name, nearest.empty() ? "" : fmt::format("did you mean '{}'? ", nearest),
                  fmt::join(known, ", ")));
}

Expected<std::string> DetectorSpecFor(std::string_view family) {
  SEXTANT_RETURN_IF_ERROR(TagCount(family));
  constexpr std::string_view kAruco = "aruco_";
  if (family.starts_with(kAruco)) {
    return fmt::format("aruco(dictionary={})", family.substr(kAruco.size()));
  }
  return fmt::format("apriltag(family={})", family);
}

}  // namespace sextant
