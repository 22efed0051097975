// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "calibrate/match/match.h"
#include "calibrate/observe/observe.h"
#include "calibrate/trust/verdict.h"
#include "geometry/board.h"
#include "geometry/camera.h"
#include "solvers/core/solver.h"

namespace sextant {

/// Settings of Calibrate. The defaults calibrate a session that names its boards and its camera.
struct CalibrateOptions {
  std::vector<Board> boards{};     ///< Empty: those of the session's board file.
  std::optional<Camera> camera{};  ///< None: the session's file, or the recording's CameraInfo.
  ObserveOptions observe{};        ///< Detector, extractor, LiDAR beam, search region and seed.
  MatchSettings match{};           ///< A pose in match.initial overrides the session's.
  double tolerance_s = 0.05;       ///< Recordings: largest gap between an image and its scan.
  /// The first solver gives the result, the others are compared with it. Empty: DefaultSolver().
  std::vector<SolverPtr> solvers{};
  /// Bootstrap samples over the views. 0: neither bootstrap nor cross-validation.
  int bootstrap_samples = 100;
  AccuracyNeed need{};  ///< For the verdict: the accuracy that the result has to have.
  /// Lines ("name: value") that describe observe.search in the result's configuration. Empty: its
  /// numbers, one line each.
  std::vector<std::string> search_description{};
  ProgressCallback progress{};  ///< Stages "views", "solvers" and "bootstrap"; may be empty.
};

/// joint(gnc(kabsch),board_size=scale): all views and their raw observations in one problem,
/// started from a robust closed form. The sizes of all boards share one factor, because the beam's
/// spot widens outlines in a scan by a percent or two, which would otherwise shorten all ranges.
SolverPtr DefaultSolver();

}  // namespace sextant
