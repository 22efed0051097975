// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "calibrate/match/match.h"
#include "calibrate/observe/observe.h"
#include "calibrate/session/rig_session.h"
#include "geometry/board.h"
#include "io/problems/rig_yaml.h"

namespace sextant {

struct ObserveRigOptions {
  std::vector<Board> boards{};  ///< Empty: those of the session's board file.
  ObserveOptions observe{};
  MatchSettings match{};
  ProgressCallback progress{};
};

/// A rig's session as a problem.
struct ObservedRig {
  RigFile rig{};
  std::vector<std::string> notes{};  ///< Files that cannot be read, pairs without a match.
};

/// Finds the boards in all images and scans, on all cores. Which patch of a scan is which board
/// follows from the cameras of the same moment (MatchViews, for every camera and LiDAR) and, where
/// none sees the board, from the other LiDARs. Errors: kMissingData without boards or moments;
/// those of ReadBoards, ReadCamera and Observer::Make.
Expected<ObservedRig> ObserveRig(const RigSession& session, const ObserveRigOptions& options);

}  // namespace sextant
