// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <opencv2/core/mat.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "calibrate/match/assemble.h"
#include "calibrate/options.h"
#include "calibrate/session/session.h"
#include "geometry/board.h"
#include "geometry/camera.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// A session with what both sensors measured of the boards in each of its views.
struct ObservedSession {
  Session session{};
  std::vector<Board> boards{};
  Camera camera{};
  std::vector<SessionView> views{};
  std::vector<std::string> notes{};  ///< Such as that the recording is cut short.
};

/// An image and a scan of one moment, in memory.
struct Frame {
  std::string name{};
  cv::Mat image{};     ///< Grey or BGR, 8 or 16 bits.
  PointCloud cloud{};  ///< In the LiDAR frame [m].
};

/// Reads the session's boards and camera, and observes its files or its recording, on all cores.
/// A view that cannot be read keeps its error (SessionView::seen).
/// Errors: kMissingData where the boards, the camera or the views are missing, and for a recording
/// in a build without recordings of ROS; those of the readers and of Observer::Make.
Expected<ObservedSession> ObserveSession(const Session& session, const CalibrateOptions& options);

/// The photo and the scan of a view, by its index, or why they cannot be read.
using FrameVisitor = std::function<void(std::size_t view, const Expected<Frame>& frame)>;

/// Reads the images and scans of the session again and passes them on, with the indices of
/// ObservedSession::views, on all cores and in no certain order; a photo and a scan for each core
/// are in memory. Errors: those of a recording as a whole.
Expected<void> VisitFrames(const Session& session, double tolerance_s, const FrameVisitor& visit);

/// The same as ObserveSession for data in memory; options.boards and options.camera are required.
Expected<ObservedSession> ObserveFrames(std::span<const Frame> frames,
                                        const CalibrateOptions& options);

}  // namespace sextant
