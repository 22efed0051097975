// SPDX-License-Identifier: Apache-2.0
#include "features/camera/find_families.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>
#include <tuple>

#include "features/camera/apriltag_detector.h"
#include "features/camera/tag_detector.h"
#include "features/camera/tags/tag_pattern.h"

namespace sextant {
namespace {

constexpr std::string_view kOpenCvPrefix = "aruco_";

int CellsOf(const std::string& family) { return MakeTagPattern(family, 0)->cells; }

// The largest of the dictionaries that begin with the tags of this one: 4x4_1000 for 4x4_50.
std::string LargestOf(const std::string& family) {
  const std::size_t size = family.find_last_of('_');
  const std::string largest = family.substr(0, size) + "_1000";
  const std::vector<std::string>& known = TagFamilies();
  return std::ranges::count(known, largest) > 0 ? largest : family;
}

bool IsReliable(const TagDetection& tag) {
  return tag.decision_margin > kReliableMargin && tag.hamming == 0;
}

std::vector<TagDetection> TagsOf(const std::string& family, const cv::Mat& grey) {
  const Expected<Detections> found =
      DetectorSpecFor(family)
          .and_then([](const std::string& spec) { return MakeTagDetector(spec); })
          .and_then([&grey](const TagDetectorPtr& detector) { return detector->Detect(grey); });
  return found ? found->tags : std::vector<TagDetection>();
}

// The searches: OpenCV's largest dictionaries, and an empty name for AprilTag's library.
std::vector<std::string> SearchedFamilies() {
  std::vector<std::string> families = {""};
  for (const std::string& family : TagFamilies()) {
    if (family.starts_with(kOpenCvPrefix) && family == LargestOf(family)) {
      families.push_back(family);
    }
  }
  return families;
}

using IdsByFamily = std::map<std::string, std::set<int>>;

IdsByFamily ReliableIds(const cv::Mat& grey) {
  const std::vector<std::string> families = SearchedFamilies();
  std::vector<std::vector<TagDetection>> found(families.size());
  tbb::parallel_for(std::size_t{0}, families.size(), [&](std::size_t i) {
    found[i] = families[i].empty() ? DetectAllAprilTags(grey) : TagsOf(families[i], grey);
  });
  IdsByFamily ids;
  for (const std::vector<TagDetection>& tags : found) {
    for (const TagDetection& tag : tags) {
      if (IsReliable(tag)) ids[tag.family].insert(tag.id);
    }
  }
  return ids;
}

}  // namespace

std::vector<FamilyMatch> FindFamilies(const cv::Mat& grey) {
  constexpr int kMaxSide_px = 1600;
  cv::Mat small = grey;
  const int side = std::max(grey.cols, grey.rows);
  if (side > kMaxSide_px) {
    const double scale = static_cast<double>(kMaxSide_px) / side;
    cv::resize(grey, small, {}, scale, scale, cv::INTER_AREA);
  }
  const IdsByFamily ids = ReliableIds(small);
  std::vector<FamilyMatch> matches;
  for (const std::string& family : TagFamilies()) {
    const auto found = ids.find(LargestOf(family));
    if (found == ids.end()) continue;
    FamilyMatch match{.family = family};
    const int count = *TagCount(family);
    std::ranges::copy_if(found->second, std::back_inserter(match.ids),
                         [count](int id) { return id < count; });
    if (!match.ids.empty()) matches.push_back(std::move(match));
  }
  return matches;
}

std::vector<FamilyMatch> OtherFamilies(std::vector<FamilyMatch> families, const std::string& except,
                                       std::span<const int> wanted_ids) {
  std::erase_if(families, [&](const FamilyMatch& match) { return match.family == except; });
  for (FamilyMatch& match : families) {
    match.wanted = 0;
    for (const int id : match.ids) {
      match.wanted += std::ranges::count(wanted_ids, id) > 0 ? 1 : 0;
    }
  }
  std::ranges::stable_sort(families, [](const FamilyMatch& a, const FamilyMatch& b) {
    return std::tuple(a.wanted, a.ids.size(), CellsOf(a.family)) >
           std::tuple(b.wanted, b.ids.size(), CellsOf(b.family));
  });
  return families;
}

}  // namespace sextant
