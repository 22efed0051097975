// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"

namespace sextant {

/// How the boards of a study are held: by nothing that the LiDAR sees, on a stand, in a person's
/// hands.
enum class BoardHolding { kHung, kOnStand, kInHands };

struct ExtractorStudyOptions {
  std::vector<std::string> models{};  ///< LiDAR models; empty: all models of the simulator.
  /// Scans of the paper's two boards at distance_m, for the errors of the corners.
  int trials = 200;
  int placements = 200;  ///< Scans of two boards anywhere in a room, for the detection rate.
  int rooms = 200;       ///< Scans of rooms without a board, for false detections.
  double distance_m = 1.8;
  double range_sigma_m = 0.01;  ///< Range noise of every model; ring biases are switched off.
  BoardHolding holding = BoardHolding::kHung;
  std::uint64_t seed = 1;
};

/// Errors of one extractor's corners.
struct ExtractorErrors {
  std::string extractor{};
  int boards = 0;         ///< Boards whose corners were extracted...
  int refused = 0;        ///< ...and boards that were found but whose corners were refused.
  double median_m = 0.0;  ///< Median distance between a corner and its true position.
  double rmse_m = 0.0;
  double outward_m = 0.0;  ///< Mean error away from the board's centre.
  double nees = 0.0;       ///< Mean of e^T C^-1 e / 3 over the corners.
};

/// Results of one LiDAR model.
struct ExtractorStudyRow {
  std::string model{};
  int due = 0;    ///< Boards hit by enough rings (without rings: by enough returns) to be found...
  int found = 0;  ///< ...and those of them that were found, within a third of their size.
  int misplaced = 0;                          ///< Boards found at a wrong place.
  int false_boards = 0;                       ///< Boards found in rooms without one.
  std::vector<ExtractorErrors> extractors{};  ///< In the order of CornerExtractors().
};

inline constexpr int kRingsDue = 6;      ///< Rings that must cross a board for it to be due.
inline constexpr int kReturnsDue = 500;  ///< The same in returns, for a sensor without rings.

/// Returns one row per model. The same seed gives the same figures on any number of threads.
/// Errors: kUnknownName; those of SimulateScan.
Expected<std::vector<ExtractorStudyRow>> StudyExtractors(const ExtractorStudyOptions& options);

/// The rows as tables, for a terminal or as Markdown.
std::string FormatExtractorStudy(const std::vector<ExtractorStudyRow>& rows, bool markdown);

}  // namespace sextant
