// SPDX-License-Identifier: Apache-2.0
#include "features/camera/find_boards.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>
#include <utility>

#include "base/spec.h"
#include "features/camera/grey_image.h"
#include "features/camera/marked_corners.h"
#include "features/camera/tags/tag_pattern.h"
#include "geometry/board_check.h"
#include "geometry/intrinsics.h"

namespace sextant {
namespace {

std::string CheckerKey(const BoardChecker& checker) {
  return fmt::format("{}x{}", checker.inner_columns, checker.inner_rows);
}

// The spec of a detector for a family: "aruco(dictionary=original,refine=subpix)" for
// "aruco_original" and "aruco(refine=subpix)".
Expected<std::string> SpecFor(const std::string& family, const std::string& detector) {
  Expected<std::string> usual = DetectorSpecFor(family);
  if (!usual || detector.empty()) return usual;
  SEXTANT_ASSIGN_OR_RETURN(SpecNode wanted, ParseSpec(detector));
  const SpecNode node = *ParseSpec(*usual);
  std::pair<std::string, std::string> option = node.options.front();
  // OpenCV detects AprilTag's families too.
  if (wanted.name == "aruco" && node.name == "apriltag") option.first = "dictionary";
  if (wanted.name != "aruco" && wanted.name != node.name) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("detector '{}' does not detect tags of {}; {} does", wanted.name,
                                 family, node.name));
  }
  wanted.options.insert(wanted.options.begin(), option);
  return FormatSpec(wanted);
}

// Renumbers the corners of a tag as in the boards' family if the other library detected it.
TagDetection AsFamily(TagDetection tag, const std::string& family) {
  if (tag.family == family) return tag;
  const Expected<TagPattern> own = MakeTagPattern(tag.family, tag.id);
  const Expected<TagPattern> wanted = MakeTagPattern(family, tag.id);
  const std::optional<int> turns = own && wanted ? QuarterTurns(*wanted, *own) : std::nullopt;
  if (turns) tag.corners_px = StartingAt(tag.corners_px, *turns);
  tag.family = family;
  return tag;
}

Expected<void> CheckBoards(const std::vector<Board>& boards) {
  std::set<std::pair<std::string, int>> tags;
  for (const Board& board : boards) {
    if (board.tags.empty() && !board.checker) {
      return MakeError(
          ErrorCode::kInvalidInput,
          fmt::format("board {} has neither tags nor a checkerboard to detect", board.id));
    }
    for (const BoardTag& tag : board.tags) {
      if (Expected<TagPattern> pattern = MakeTagPattern(tag.family, tag.id); !pattern) {
        return MakeError(pattern.error().code,
                         fmt::format("board {}: {}", board.id, pattern.error().message));
      }
      if (!tags.emplace(tag.family, tag.id).second) {
        return MakeError(ErrorCode::kInvalidInput,
                         fmt::format("tag {} of {} is on two boards", tag.id, tag.family));
      }
    }
  }
  return {};
}

BoardPoints PointsOf(const BoardTag& tag, const SeenTag& seen) {
  BoardPoints points;
  const std::array<Eigen::Vector2d, 4> corners = TagCorners(tag);
  points.in_board_m.assign(corners.begin(), corners.end());
  const Quad& pixels = seen.refined ? seen.refined->corners_px : seen.detection.corners_px;
  points.pixels.assign(pixels.begin(), pixels.end());
  if (seen.refined) {
    points.covariance_px2 = seen.refined->covariance_px2;
  } else {
    points.covariance_px2 = kDetectorSigma_px * kDetectorSigma_px * Matrix8d::Identity();
  }
  return points;
}

BoardPoints PointsOf(const BoardChecker& checker, const CheckerDetection& seen) {
  BoardPoints points;
  for (int row = 0; row < checker.inner_rows; ++row) {
    for (int column = 0; column < checker.inner_columns; ++column) {
      points.in_board_m.emplace_back(checker.center_in_board_m +
                                     checker.square_m *
                                         Eigen::Vector2d(column - 0.5 * (checker.inner_columns - 1),
                                                         row - 0.5 * (checker.inner_rows - 1)));
    }
  }
  points.pixels = seen.corners_px;
  const auto size = 2 * std::ssize(points.pixels);
  points.covariance_px2 =
      kCheckerSigma_px * kCheckerSigma_px * Eigen::MatrixXd::Identity(size, size);
  return points;
}

using Detectors = std::map<std::string, TagDetectorPtr>;

Expected<void> Add(const std::string& key, const std::string& spec, Detectors& detectors) {
  return MakeTagDetector(spec).map([&](TagDetectorPtr made) { detectors[key] = std::move(made); });
}

// The same detector on an image decimated by two; none if the user set the decimation.
std::optional<std::string> QuickSpec(const std::string& spec) {
  SpecNode node = *ParseSpec(spec);
  for (const auto& [option, value] : node.options) {
    if (option == "decimate") return std::nullopt;
  }
  node.options.emplace_back("decimate", "2");
  return FormatSpec(node);
}

// Appends the detections of all detectors to `found`.
Expected<void> DetectAll(const cv::Mat& grey, const Detectors& detectors, Detections& found) {
  for (const auto& [family, detector] : detectors) {
    SEXTANT_ASSIGN_OR_RETURN(Detections some, detector->Detect(grey));
    for (TagDetection& tag : some.tags) {
      found.tags.push_back(AsFamily(std::move(tag), family));
    }
    for (CheckerDetection& checker : some.checkers) found.checkers.push_back(std::move(checker));
  }
  return {};
}

bool HasAllTags(const SeenBoards& seen) {
  return std::ranges::all_of(seen.boards, [](const SeenBoard& board) {
    return board.missing_tags.empty() && board.duplicate_tags.empty() &&
           std::ranges::all_of(board.tags,
                               [](const SeenTag& tag) { return tag.refined.has_value(); });
  });
}

}  // namespace

Expected<BoardFinder> BoardFinder::Make(std::vector<Board> boards, std::optional<Camera> camera,
                                        const std::string& detector) {
  SEXTANT_RETURN_IF_ERROR(CheckBoards(boards));
  BoardFinder finder;
  for (const Board& board : boards) {
    for (const BoardTag& tag : board.tags) {
      if (finder.detectors_.contains(tag.family)) continue;
      SEXTANT_ASSIGN_OR_RETURN(const std::string spec, SpecFor(tag.family, detector));
      SEXTANT_RETURN_IF_ERROR(Add(tag.family, spec, finder.detectors_));
      if (const std::optional<std::string> quick = QuickSpec(spec)) {
        SEXTANT_RETURN_IF_ERROR(Add(tag.family, *quick, finder.quick_));
      }
    }
    if (!board.checker || board.checker->holds_tags) continue;
    SEXTANT_RETURN_IF_ERROR(
        Add(CheckerKey(*board.checker),
            fmt::format("checkerboard(columns={},rows={})", board.checker->inner_columns,
                        board.checker->inner_rows),
            finder.checkers_));
  }
  finder.boards_ = std::move(boards);
  finder.camera_ = camera;
  return finder;
}

Expected<SeenBoards> BoardFinder::Find(const cv::Mat& image) const {
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat grey, ToGrey(image));
  if (camera_ && camera_->width_px > 0 &&
      (grey.cols != camera_->width_px || grey.rows != camera_->height_px)) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the image has {} x {} pixels, expected {} x {} as in the camera",
                                 grey.cols, grey.rows, camera_->width_px, camera_->height_px));
  }
  if (camera_ && camera_->width_px == 0) {
    SEXTANT_RETURN_IF_ERROR(ValidateCamera(WithImageSize(*camera_, grey.cols, grey.rows)));
  }
  Detections checkers;
  SEXTANT_RETURN_IF_ERROR(DetectAll(grey, checkers_, checkers));
  if (!quick_.empty() && quick_.size() == detectors_.size()) {
    Detections found = checkers;
    SEXTANT_RETURN_IF_ERROR(DetectAll(grey, quick_, found));
    SeenBoards seen = Assemble(grey, std::move(found));
    if (HasAllTags(seen)) return seen;
  }
  SEXTANT_RETURN_IF_ERROR(DetectAll(grey, detectors_, checkers));
  return Assemble(grey, std::move(checkers));
}

SeenBoards BoardFinder::Assemble(const cv::Mat& grey, Detections found) const {
  SeenBoards seen;
  for (std::size_t i = 0; i < boards_.size(); ++i) {
    seen.boards.push_back(Assign(i, grey, found));
    AddPoints(grey, seen.boards.back());
    if (camera_) AddPose(seen.boards.back());
  }
  seen.other_tags = std::move(found.tags);
  return seen;
}

// Moves the detections that belong to the board out of `found`.
SeenBoard BoardFinder::Assign(std::size_t index, const cv::Mat& grey, Detections& found) const {
  const Board& board = boards_[index];
  const Undistortion undistortion = camera_ ? Undistortion(*camera_) : Undistortion();
  SeenBoard seen{.index = index};
  for (std::size_t i = 0; i < board.tags.size(); ++i) {
    const BoardTag& tag = board.tags[i];
    std::vector<TagDetection> here;
    std::erase_if(found.tags, [&](const TagDetection& detection) {
      const bool is_it = detection.family == tag.family && detection.id == tag.id;
      if (is_it) here.push_back(detection);
      return is_it;
    });
    if (here.empty()) seen.missing_tags.push_back(i);
    if (here.size() > 1) seen.duplicate_tags.push_back(i);
    if (here.size() != 1) continue;
    const TagPattern pattern = *MakeTagPattern(tag.family, tag.id);
    seen.tags.push_back({.index = i,
                         .detection = here[0],
                         .refined = RefineTag(grey, here[0].corners_px, pattern, undistortion)});
  }
  if (board.checker && !board.checker->holds_tags) {
    const auto match = std::ranges::find_if(found.checkers, [&](const CheckerDetection& c) {
      return c.inner_columns == board.checker->inner_columns &&
             c.inner_rows == board.checker->inner_rows;
    });
    seen.is_checker_missing = match == found.checkers.end();
    if (!seen.is_checker_missing) {
      seen.checker = *match;
      found.checkers.erase(match);
    }
  }
  return seen;
}

void BoardFinder::AddPoints(const cv::Mat& grey, SeenBoard& seen) const {
  const Board& board = boards_[seen.index];
  for (const SeenTag& tag : seen.tags) seen.printed.push_back(PointsOf(board.tags[tag.index], tag));
  if (board.checker && board.checker->holds_tags) {
    BoardPoints corners = FindMarkedCorners(grey, *board.checker, seen.printed);
    seen.is_checker_missing = corners.pixels.empty();
    // Far more accurate than the tags, which are small.
    if (!seen.is_checker_missing) seen.printed = {std::move(corners)};
  }
  if (seen.checker) seen.printed.push_back(PointsOf(*board.checker, *seen.checker));
}

void BoardFinder::AddPose(SeenBoard& seen) const {
  if (seen.printed.empty()) return;
  seen.pose = EstimateBoardPose(*camera_, seen.printed);
  if (*seen.pose) seen.corners = ToCamera(**seen.pose, BoardCorners(boards_[seen.index]));
}

}  // namespace sextant
