// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "calibrate/bag/observe_bag.h"
#include "calibrate/match/assemble.h"
#include "calibrate/observe/observe.h"
#include "geometry/board.h"
#include "geometry/camera.h"

namespace sextant {

struct RecordingOptions {
  BagSource source{};
  std::vector<Board> boards{};
  std::optional<Camera> camera{};  ///< None: the one in the recording's CameraInfo messages.
  ObserveOptions observe{};
};

struct RecordedViews {
  Camera camera{};  ///< The one that the images were examined with.
  std::vector<SessionView> views{};
  std::string note{};  ///< What is missing of a recording that is cut short; else empty.
};

/// Opens a recording, pairs its images and scans by time stamp and observes the boards in them.
/// Errors: those of OpenBag, PlanBag, Observer::Make and ObserveBag; kMissingData where neither the
/// options nor the recording have the camera's intrinsics.
Expected<RecordedViews> ObserveRecording(const std::filesystem::path& path,
                                         const RecordingOptions& options,
                                         const ProgressCallback& progress);

}  // namespace sextant
