// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"

namespace sextant {

/// How the boards of a study are held.
enum class BoardHolding { kHung, kOnStand, kInHands };

struct ExtractorStudyOptions {
  std::vector<std::string> models{};  ///< LiDARs; empty: all that the simulator has.
  int trials = 200;      ///< Scans of the paper's two boards 1.8 m away, for the corners' errors.
  int placements = 200;  ///< Scans of two boards anywhere in a room, for what is found.
  int rooms = 200;       ///< Scans of rooms without a board.
  double distance_m = 1.8;
  double range_sigma_m = 0.01;  ///< Of every model, without the rings' own biases.
  BoardHolding holding = BoardHolding::kHung;
  std::uint64_t seed = 1;
};

/// Errors of one extractor's corners.
struct ExtractorErrors {
  std::string extractor{};
  int boards = 0;         ///< Of which corners were got...
  int refused = 0;        ///< ...and of which they were not, though the board was found.
  double median_m = 0.0;  ///< Of the distances between corners and their truth.
  double rmse_m = 0.0;
  double outward_m = 0.0;  ///< Mean error away from the board's middle.
  double nees = 0.0;       ///< Mean of e^T C^-1 e / 3 over the corners.
};

/// What one LiDAR sees.
struct ExtractorStudyRow {
  std::string model{};
  int due = 0;           ///< Boards that enough rings cross (or returns lie on, without rings)...
  int found = 0;         ///< ...and of them those that were found, to a third of their size.
  int misplaced = 0;     ///< Found elsewhere.
  int false_boards = 0;  ///< In rooms without one.
  std::vector<ExtractorErrors> extractors{};  ///< As CornerExtractors().
};

inline constexpr int kRingsDue = 6;      ///< That must cross a board for it to be found.
inline constexpr int kReturnsDue = 500;  ///< That must lie on it, of a sensor without rings.

/// A row for each model. The same seed gives the same figures on any number of threads.
/// Errors: kUnknownName; those of SimulateScan.
Expected<std::vector<ExtractorStudyRow>> StudyExtractors(const ExtractorStudyOptions& options);

/// The rows as tables, for a terminal or as Markdown.
std::string FormatExtractorStudy(const std::vector<ExtractorStudyRow>& rows, bool markdown);

}  // namespace sextant
