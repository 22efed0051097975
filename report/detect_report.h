// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "features/camera/explain_missing.h"
#include "features/camera/find_boards.h"

namespace sextant {

/// A tag of a board that was not found, and why.
struct ExplainedTag {
  std::size_t board = 0;  ///< Index into the boards that were searched for.
  std::size_t tag = 0;    ///< Index into Board::tags.
  MissingTag why{};
};

/// All that `sextant detect` finds in one image.
struct ImageReport {
  std::string path{};
  cv::Size size{};
  SeenBoards seen{};  ///< Without a board, `other_tags` has all tags.
  std::vector<ExplainedTag> missing{};
  std::vector<CheckerDetection> checkers{};   ///< Without a board.
  std::vector<FamilyMatch> other_families{};  ///< Without a board, if no tag was found.
  bool sought_checkers = false;  ///< Without a board: the detector finds checkerboards.
};

/// The report of an image, or an error whose message names the file.
using ImageResult = Expected<ImageReport>;

/// For people.
std::string DescribeDetection(const ImageReport& report, const std::vector<Board>& boards);

/// For programs: {"sextant", "images": [...]}; see docs/formats.md.
std::string FormatDetections(const std::vector<std::string>& paths,
                             const std::vector<ImageResult>& results,
                             const std::vector<Board>& boards);

/// The image in colour with tags, boards' outlines and axes drawn on it.
cv::Mat DrawDetection(const cv::Mat& image, const ImageReport& report,
                      const std::vector<Board>& boards, const std::optional<Camera>& camera);

}  // namespace sextant
