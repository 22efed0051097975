// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/match/assemble.h"
#include "calibrate/observe/observe.h"
#include "calibrate/session/session.h"

namespace sextant::cli {

/// How a recording is looked at.
struct ObserveRecording {
  std::vector<Board> boards{};
  std::optional<Camera> camera{};  ///< None: that of the recording's CameraInfo.
  ObserveOptions observe{};
  double tolerance_s = 0.05;
};

struct RecordedViews {
  Camera camera{};
  std::vector<SessionView> views{};
  std::string summary{};  ///< Which topics, and how many pairs, in one line.
};

/// The views of a recording, with a progress bar. Errors: those of OpenBag, PlanBag, Observer::Make
/// and ObserveBag; kMissingData where no camera is known, and where this build reads no recordings.
Expected<RecordedViews> LookAtRecording(const Session& session, const ObserveRecording& how);

}  // namespace sextant::cli
