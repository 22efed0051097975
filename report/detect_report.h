// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "features/camera/explain_missing.h"
#include "features/camera/find_boards.h"

namespace sextant::cli {

/// A tag of a board that was not found, and why.
struct ExplainedTag {
  std::size_t board = 0;  ///< Into the boards that were looked for.
  std::size_t tag = 0;    ///< Into Board::tags.
  MissingTag why{};
};

/// All that `sextant detect` finds in one image.
struct ImageReport {
  std::string path{};
  cv::Size size{};
  SeenBoards seen{};  ///< Its other_tags are all tags where no board is given.
  std::vector<ExplainedTag> missing{};
  std::vector<CheckerDetection> checkers{};   ///< Where no board is given.
  std::vector<FamilyMatch> other_families{};  ///< Where no board is given and no tag was found.
  bool sought_checkers = false;  ///< Where no board is given: checkerboards instead of tags.
};

/// An image's report, or why there is none; the error's message names the file.
using ImageResult = Expected<ImageReport>;

std::string DescribeDetection(const ImageReport& report, const std::vector<Board>& boards);

/// {"sextant", "images": [...]}, see docs/formats.md.
std::string FormatDetections(const std::vector<std::string>& paths,
                             const std::vector<ImageResult>& results,
                             const std::vector<Board>& boards);

/// The image in colour with tags, boards' outlines and axes drawn on it.
cv::Mat DrawDetection(const cv::Mat& image, const ImageReport& report,
                      const std::vector<Board>& boards, const std::optional<Camera>& camera);

}  // namespace sextant::cli
