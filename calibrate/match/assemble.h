// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "calibrate/match/match.h"
#include "calibrate/match/repeated_views.h"
#include "calibrate/observe/observe.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// One moment of a session.
struct SessionView {
  std::string name{};
  std::string image_path{};  ///< Empty for recordings and data in memory, as is cloud_path.
  std::string cloud_path{};
  std::optional<double> image_time_s{};  ///< Recordings only: seconds since 1970.
  std::optional<double> cloud_time_s{};
  Expected<Observation> seen{};  ///< Or the error that prevented its observation.
};

enum class BoardStatus {
  kKept,
  kUnreadable,  ///< The view's image or scan cannot be read.
  kLeftOut,     ///< Excluded before matching; see CameraSighting::left_out.
  kNotInImage,
  kNotInScan,
  kDisagrees,    ///< The scan's candidate contradicts the image, or its pose the other views.
  kContradicts,  ///< The solver left it out: its data contradict the other views.
  kCopy,         ///< Its image and scan are those of an earlier view.
};
std::string_view ToString(BoardStatus fate);

/// Status of a board in a view.
struct BoardRow {
  std::size_t view = 0;
  int board = -1;  ///< Index into the boards; -1: the view as a whole.
  BoardStatus fate = BoardStatus::kKept;
  std::string why{};  ///< The reason, in one line, where it was not kept.
};

/// The observations of a session as a problem for the solvers.
struct Assembly {
  /// Pairs and raw observations of every board that was kept; PairId::view is the index into the
  /// session's views. It has the camera, the boards, and the matching's pose as the initial one.
  CalibrationProblem problem{};
  Matching matching{};
  std::vector<RepeatedPlacement>
      repeated{};                ///< Their views weigh as much as one view in `problem`.
  std::vector<BoardRow> rows{};  ///< By view, then board.
};

/// Matches the boards of all views and collects both sensors' measurements of them. Copies of a
/// view are left out, and views that show a board in one place count as one. Errors: kMissingData
/// where no view has a board that both sensors saw, and where most views whose image shows a board
/// lack it in the scan or disagree, with the reasons; kDegenerate where the matched boards do not
/// determine a pose.
Expected<Assembly> Assemble(std::span<const SessionView> views, std::span<const Board> boards,
                            const Camera& camera, const MatchSettings& settings = {});

}  // namespace sextant
