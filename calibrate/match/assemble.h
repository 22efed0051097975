// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "calibrate/match/match.h"
#include "calibrate/observe/observe.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// One moment of a session.
struct SessionView {
  std::string name{};
  std::string image_path{};  ///< Empty where it is from a recording; so is cloud_path.
  std::string cloud_path{};
  std::optional<double> image_time_s{};  ///< Of a recording: since 1970.
  std::optional<double> cloud_time_s{};
  Expected<Observation> seen{};  ///< Or why it could not be looked at.
};

enum class BoardFate {
  kKept,
  kUnreadable,  ///< The view's image or scan.
  kLeftOut,     ///< CameraSighting::left_out.
  kNotInImage,
  kNotInScan,
  kDisagrees,  ///< With the other views.
};
std::string_view ToString(BoardFate fate);

/// What became of a board in a view.
struct BoardRow {
  std::size_t view = 0;
  int board = -1;  ///< Place within the boards; -1: the view as a whole.
  BoardFate fate = BoardFate::kKept;
  std::string why{};  ///< Where it was not kept: one line.
};

/// A session made ready for the solvers.
struct Assembly {
  /// Pairs and raw observations of every board that was kept; `view` of their ids is the place
  /// within the session's views. With the camera, the boards, and the matching's pose as the
  /// initial one.
  CalibrationProblem problem{};
  Matching matching{};
  std::vector<BoardRow> rows{};  ///< By view, then board.
};

/// Matches the boards of all views and gathers what both sensors measured of them.
/// Errors: kMissingData where no view has a board that both sensors saw, with what each lacked;
/// kDegenerate.
Expected<Assembly> Assemble(std::span<const SessionView> views, std::span<const Board> boards,
                            const Camera& camera, const MatchSettings& settings = {});

}  // namespace sextant
