// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "features/camera/board_pose.h"
#include "features/camera/edge_refine.h"
#include "features/camera/tag_detector.h"
#include "geometry/board.h"

namespace sextant {

/// A tag of a board, where the image shows it.
struct SeenTag {
  std::size_t index = 0;  ///< Into Board::tags.
  TagDetection detection{};
  /// By RefineTag; the reason where it could not, and the detector's own corners are used.
  Expected<RefinedTag> refined;
};

/// A board with what the image shows of it.
struct SeenBoard {
  std::size_t index = 0;  ///< Into the boards that were looked for.
  std::vector<SeenTag> tags{};
  std::optional<CheckerDetection> checker{};
  std::vector<std::size_t> missing_tags{};  ///< Into Board::tags.
  bool is_checker_missing = false;
  std::vector<std::size_t> duplicate_tags{};  ///< Seen more than once, and so not used.
  std::vector<BoardPoints> printed{};  ///< What the pose rests on: a group a tag or checkerboard.
  std::optional<Expected<BoardPose>> pose{};  ///< None where no camera was given or nothing seen.
  PointsInCam corners{};                      ///< Of BoardCorners, where there is a pose.
};

struct SeenBoards {
  std::vector<SeenBoard> boards{};         ///< One for each that was looked for, in that order.
  std::vector<TagDetection> other_tags{};  ///< Of the boards' families, but on none of them.
};

/// Looks for boards in images. Immutable and thread-safe.
class BoardFinder {
 public:
  /// Makes a detector for each family and each size of checkerboard on the boards. `detector`
  /// names the library that is to find tags, "aruco" or "apriltag", with options but without the
  /// family, which comes from the boards; empty: AprilTag's for its families, else OpenCV's.
  /// Errors: kUnknownName for a family, kInvalidOption for a library that does not read it;
  /// kInvalidInput for boards without tags and checkerboard and for a tag on two boards.
  static Expected<BoardFinder> Make(std::vector<Board> boards, std::optional<Camera> camera,
                                    const std::string& detector = "");

  const std::vector<Board>& boards() const { return boards_; }
  const std::optional<Camera>& camera() const { return camera_; }

  /// Tags are looked for in the image reduced by two, unless `detector` says otherwise, and in the
  /// whole image only where that left a tag out, or one that could not be refined.
  /// Errors: those of TagDetector::Detect; kInvalidInput for an image of another size than the
  /// camera's.
  Expected<SeenBoards> Find(const cv::Mat& image) const;

 private:
  using Detectors = std::map<std::string, TagDetectorPtr>;

  BoardFinder() = default;
  SeenBoards Assemble(const cv::Mat& grey, Detections found) const;
  SeenBoard Assign(std::size_t index, const cv::Mat& grey, Detections& found) const;
  void AddPoints(SeenBoard& seen) const;
  void AddPose(SeenBoard& seen) const;

  std::vector<Board> boards_;
  std::optional<Camera> camera_;
  Detectors detectors_;  ///< By the boards' family.
  Detectors quick_;      ///< Those that look at the image reduced by two first.
  Detectors checkers_;   ///< By "7x5".
};

/// Standard deviation of a corner that has only the detector's own accuracy, per axis [px]:
/// docs/detectors.md.
inline constexpr double kDetectorSigma_px = 0.5;
inline constexpr double kCheckerSigma_px = 0.1;

}  // namespace sextant
