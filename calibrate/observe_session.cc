// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe_session.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <memory>

#include "calibrate/observe/photo_file.h"
#include "calibrate/session/observe_files.h"
#include "io/boards/board_file.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/cloud_file.h"
#include "io/text/text_file.h"
#ifdef SEXTANT_WITH_BAG
#include "calibrate/bag/observe_recording.h"
#endif

namespace sextant {
namespace {

Expected<std::vector<Board>> BoardsFor(const Session& session, const CalibrateOptions& options) {
  if (!options.boards.empty()) return options.boards;
  if (!session.boards.empty()) return ReadBoards(session.boards);
  return MakeError(ErrorCode::kMissingData,
                   "the boards are missing: the session does not name a board file");
}

// None where a recording may have the camera.
Expected<std::optional<Camera>> CameraFor(const Session& session, const CalibrateOptions& options) {
  if (options.camera) return options.camera;
  if (!session.camera.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const Camera camera, ReadCamera(session.camera));
    return std::optional<Camera>(camera);
  }
  if (!session.bag.empty()) return std::optional<Camera>();
  return MakeError(ErrorCode::kMissingData,
                   "the camera is missing: the session does not name a camera file");
}

Expected<Frame> ReadFrame(const FilePair& pair) {
  Frame frame{.name = pair.name};
  SEXTANT_ASSIGN_OR_RETURN(frame.image, ReadImage(pair.image));
  SEXTANT_ASSIGN_OR_RETURN(frame.cloud, ReadCloud(pair.cloud));
  return frame;
}

#ifdef SEXTANT_WITH_BAG
BagSource SourceOf(const Session& session, double tolerance_s) {
  return {.image_topic = session.image_topic,
          .cloud_topic = session.cloud_topic,
          .tolerance_s = tolerance_s};
}

Expected<void> VisitRecording(const Session& session, double tolerance_s,
                              const FrameVisitor& visit) {
  SEXTANT_ASSIGN_OR_RETURN(const std::unique_ptr<Bag> bag, OpenBag(session.bag));
  SEXTANT_ASSIGN_OR_RETURN(const BagPlan plan, PlanBag(*bag, SourceOf(session, tolerance_s)));
  return VisitMoments(
      *bag, plan,
      [&](std::size_t i, const Expected<cv::Mat>& image, const Expected<PointCloud>& cloud) {
        if (!image) return visit(i, tl::unexpected<Error>(image.error()));
        if (!cloud) return visit(i, tl::unexpected<Error>(cloud.error()));
        visit(i, Frame{.image = *image, .cloud = *cloud});
      });
}

Expected<void> ObserveBagOf(const CalibrateOptions& options, const std::optional<Camera>& camera,
                            ObservedSession& observed) {
  const Session& session = observed.session;
  SEXTANT_ASSIGN_OR_RETURN(RecordedViews recorded,
                           ObserveRecording(session.bag,
                                            {.source = SourceOf(session, options.tolerance_s),
                                             .boards = observed.boards,
                                             .camera = camera,
                                             .observe = options.observe},
                                            options.progress));
  observed.camera = recorded.camera;
  observed.views = std::move(recorded.views);
  if (!recorded.note.empty()) observed.notes.push_back(std::move(recorded.note));
  return {};
}
#else
tl::unexpected<Error> NoRecordings(const Session& session) {
  return MakeError(ErrorCode::kMissingData,
                   fmt::format("cannot read '{}': this build has no recordings of ROS. Install "
                               "libbz2-dev, liblz4-dev, libzstd-dev and libsqlite3-dev, configure "
                               "with -DSEXTANT_BAG=ON and build again",
                               session.bag.string()));
}

Expected<void> VisitRecording(const Session& session, double, const FrameVisitor&) {
  return NoRecordings(session);
}

Expected<void> ObserveBagOf(const CalibrateOptions&, const std::optional<Camera>&,
                            ObservedSession& observed) {
  return NoRecordings(observed.session);
}
#endif

}  // namespace

Expected<ObservedSession> ObserveSession(const Session& session, const CalibrateOptions& options) {
  ObservedSession observed{.session = session};
  SEXTANT_ASSIGN_OR_RETURN(std::vector<Board> boards, BoardsFor(session, options));
  observed.boards = std::move(boards);
  SEXTANT_ASSIGN_OR_RETURN(const std::optional<Camera> camera, CameraFor(session, options));
  if (!session.bag.empty()) {
    SEXTANT_RETURN_IF_ERROR(ObserveBagOf(options, camera, observed));
    return observed;
  }
  observed.camera = *camera;
  SEXTANT_ASSIGN_OR_RETURN(const Observer observer,
                           Observer::Make(observed.boards, observed.camera, options.observe));
  const std::vector<FilePair>& pairs = session.files.pairs;
  if (pairs.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("no image has a scan: {} files have no partner; files are paired "
                                 "by the distinguishing part of their names",
                                 session.files.without_partner.size()));
  }
  for (const FilePair& pair : pairs) {
    SEXTANT_RETURN_IF_ERROR(CheckInput(pair.image));
    SEXTANT_RETURN_IF_ERROR(CheckInput(pair.cloud));
  }
  ProgressCounter counter(options.progress, "views", pairs.size());
  observed.views = ObserveFiles(observer, pairs, [&counter] { counter.Step(); });
  counter.Finish();
  return observed;
}

Expected<void> VisitFrames(const Session& session, double tolerance_s, const FrameVisitor& visit) {
  if (!session.bag.empty()) return VisitRecording(session, tolerance_s, visit);
  const std::vector<FilePair>& pairs = session.files.pairs;
  tbb::parallel_for(std::size_t{0}, pairs.size(),
                    [&](std::size_t i) { visit(i, ReadFrame(pairs[i])); });
  return {};
}

Expected<ObservedSession> ObserveFrames(std::span<const Frame> frames,
                                        const CalibrateOptions& options) {
  if (options.boards.empty() || !options.camera || frames.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("expected frames, boards and a camera, got {} frames, {} boards "
                                 "and {} camera",
                                 frames.size(), options.boards.size(), options.camera ? 1 : 0));
  }
  ObservedSession observed{.boards = options.boards, .camera = *options.camera};
  SEXTANT_ASSIGN_OR_RETURN(const Observer observer,
                           Observer::Make(observed.boards, observed.camera, options.observe));
  observed.views.resize(frames.size());
  ProgressCounter counter(options.progress, "views", frames.size());
  tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t i) {
    observed.views[i].name = frames[i].name;
    observed.views[i].seen = observer.Observe(frames[i].image, frames[i].cloud);
    counter.Step();
  });
  counter.Finish();
  return observed;
}

}  // namespace sextant
