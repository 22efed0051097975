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

/// A tag of a board that was detected in the image.
struct SeenTag {
  std::size_t index = 0;  ///< Index into Board::tags.
  TagDetection detection{};
  /// The result of RefineTag; if it failed, the error, and the detector's corners are used.
  Expected<RefinedTag> refined;
};

/// What was detected of a board.
struct SeenBoard {
  std::size_t index = 0;  ///< Index into BoardFinder::boards().
  std::vector<SeenTag> tags{};
  std::optional<CheckerDetection> checker{};
  std::vector<std::size_t> missing_tags{};  ///< Indices into Board::tags.
  bool is_checker_missing = false;
  std::vector<std::size_t> duplicate_tags{};  ///< Tags seen more than once, which are not used.
  /// Input of the pose: a group for each tag or checkerboard; of a checkerboard that holds tags
  /// only its own corners, where they were found.
  std::vector<BoardPoints> printed{};
  std::optional<Expected<BoardPose>> pose{};  ///< None without a camera or without any detection.
  PointsInCam corners{};                      ///< Those of BoardCorners; empty without a pose.
};

struct SeenBoards {
  std::vector<SeenBoard> boards{};         ///< One for each of BoardFinder::boards(), in order.
  std::vector<TagDetection> other_tags{};  ///< Tags of the boards' families, on no board.
};

/// Finds boards in images. Immutable and thread-safe.
class BoardFinder {
 public:
  /// Makes a detector for each family and each size of checkerboard on the boards. `detector` is
  /// the library that detects tags, "aruco" or "apriltag", with options but without the family,
  /// which comes from the boards; empty: AprilTag's library for its families, else OpenCV's.
  /// Errors: kUnknownName for a family, kInvalidOption for a library that does not read it;
  /// kInvalidInput for boards without tags and checkerboard and for a tag on two boards.
  static Expected<BoardFinder> Make(std::vector<Board> boards, std::optional<Camera> camera,
                                    const std::string& detector = "");

  const std::vector<Board>& boards() const { return boards_; }
  const std::optional<Camera>& camera() const { return camera_; }

  /// Searches the image decimated by two first, unless `detector` sets another decimation, and the
  /// full image only if a tag was missed or could not be refined.
  /// Errors: those of TagDetector::Detect; kInvalidInput if the image's size differs from the
  /// camera's.
  Expected<SeenBoards> Find(const cv::Mat& image) const;

 private:
  using Detectors = std::map<std::string, TagDetectorPtr>;

  BoardFinder() = default;
  SeenBoards Assemble(const cv::Mat& grey, Detections found) const;
  SeenBoard Assign(std::size_t index, const cv::Mat& grey, Detections& found) const;
  void AddPoints(const cv::Mat& grey, SeenBoard& seen) const;
  void AddPose(SeenBoard& seen) const;

  std::vector<Board> boards_;
  std::optional<Camera> camera_;
  Detectors detectors_;  ///< By family.
  Detectors quick_;      ///< The same detectors on the image decimated by two, tried first.
  Detectors checkers_;   ///< By size: "7x5".
};

/// Standard deviation, per axis [px], of a corner that was not refined: docs/detectors.md.
inline constexpr double kDetectorSigma_px = 0.5;
inline constexpr double kCheckerSigma_px = 0.1;

}  // namespace sextant
