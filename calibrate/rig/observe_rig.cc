// SPDX-License-Identifier: Apache-2.0
#include "calibrate/rig/observe_rig.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <utility>

#include "base/text/printable.h"
#include "calibrate/match/assemble.h"
#include "calibrate/match/matched_board.h"
#include "calibrate/observe/photo_file.h"
#include "calibrate/rig/scan_as_image.h"
#include "io/boards/board_file.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/cloud_file.h"

namespace sextant {
namespace {

using Observations = std::vector<std::optional<Expected<Observation>>>;  ///< By moment.

Expected<Observation> ObserveFile(const Observer& observer, bool image,
                                  const std::filesystem::path& path) {
  Observation seen;
  if (image) {
    SEXTANT_ASSIGN_OR_RETURN(const cv::Mat photo, ReadImage(path));
    SEXTANT_RETURN_IF_ERROR(observer.ObserveImage(photo, seen));
  } else {
    SEXTANT_ASSIGN_OR_RETURN(const PointCloud cloud, ReadCloud(path));
    SEXTANT_RETURN_IF_ERROR(observer.ObserveScan(cloud, seen));
  }
  return seen;
}

/// Collects the observations of all sensors, and the LiDARs' matches with every camera.
class RigAssembly {
 public:
  RigAssembly(const RigSession& session, const ObserveRigOptions& options,
              std::vector<Board> boards)
      : session_(session), options_(options), boards_(std::move(boards)) {
    result_.rig.root = session.root;
    result_.rig.problem.boards = boards_;
  }

  Expected<ObservedRig> Run() {
    SEXTANT_RETURN_IF_ERROR(MakeObservers());
    Observe();
    for (std::size_t s = 0; s < session_.sensors.size(); ++s) {
      if (IsCamera(s)) AddCamera(s);
    }
    for (std::size_t s = 0; s < session_.sensors.size(); ++s) {
      if (!IsCamera(s)) AddLidar(s);
    }
    for (std::size_t s = 0; s < session_.sensors.size(); ++s) {
      for (std::size_t r = 0; r < session_.sensors.size(); ++r) {
        if (s != r && !IsCamera(s) && !IsCamera(r)) AddByLidar(s, r);
      }
    }
    for (auto& [key, placement] : placements_) {
      result_.rig.problem.placements.push_back(std::move(placement));
    }
    return std::move(result_);
  }

 private:
  bool IsCamera(std::size_t sensor) const { return !session_.sensors[sensor].camera.empty(); }

  // A scan needs no camera; the observer of scans has one that is not used.
  Expected<void> MakeObservers() {
    for (const SessionSensor& of : session_.sensors) {
      RigSensor sensor{.name = of.name};
      Camera camera{.width_px = 640,
                    .height_px = 480,
                    .fx_px = 500.0,
                    .fy_px = 500.0,
                    .cx_px = 319.5,
                    .cy_px = 239.5};
      if (!of.camera.empty()) {
        SEXTANT_ASSIGN_OR_RETURN(sensor.camera, ReadCamera(of.camera));
        camera = *sensor.camera;
      }
      SEXTANT_ASSIGN_OR_RETURN(Observer observer,
                               Observer::Make(boards_, camera, options_.observe));
      observers_.push_back(std::move(observer));
      result_.rig.problem.sensors.push_back(std::move(sensor));
      if (of.true_rig_from_sensor) {
        result_.rig.true_rig_from_sensor.push_back(*of.true_rig_from_sensor);
      }
    }
    if (result_.rig.true_rig_from_sensor.size() != observers_.size()) {
      result_.rig.true_rig_from_sensor.clear();
    }
    return {};
  }

  void Observe() {
    const std::size_t sensors = session_.sensors.size();
    const std::size_t count = session_.moments.size() * sensors;
    seen_.assign(sensors, Observations(session_.moments.size()));
    ProgressCounter counter(options_.progress, "views", count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
      const std::size_t s = k % sensors;
      const std::size_t m = k / sensors;
      const std::filesystem::path& file = session_.moments[m].files[s];
      if (!file.empty()) seen_[s][m].emplace(ObserveFile(observers_[s], IsCamera(s), file));
      counter.Step();
    });
    counter.Finish();
    for (std::size_t s = 0; s < sensors; ++s) {
      for (std::size_t m = 0; m < session_.moments.size(); ++m) {
        if (!seen_[s][m] || *seen_[s][m]) continue;
        result_.notes.push_back(fmt::format("{}: {}",
                                            Printable(session_.moments[m].files[s].string(), 300),
                                            seen_[s][m]->error().message));
      }
    }
  }

  const Observation* SeenBy(std::size_t sensor, std::size_t moment) const {
    const auto& seen = seen_[sensor][moment];
    return seen && *seen ? &**seen : nullptr;
  }

  RigPlacement& PlacementOf(std::size_t moment, int board) {
    RigPlacement& placement = placements_[{moment, board}];
    placement.moment = static_cast<int>(moment);
    placement.board = board;
    placement.name = session_.moments[moment].name;
    return placement;
  }

  void AddCamera(std::size_t sensor) {
    for (std::size_t m = 0; m < session_.moments.size(); ++m) {
      const Observation* seen = SeenBy(sensor, m);
      if (seen == nullptr) continue;
      for (const CameraSighting& sighting : seen->in_image) {
        if (!sighting.left_out.empty()) continue;
        RigObservation observation{.sensor = sensor};
        observation.raw.printed = sighting.printed;
        // Without a pose, the solver compares both of an ambiguous print.
        if (!sighting.pose.ambiguous_with) {
          observation.sensor_from_board = sighting.pose.cam_from_board;
        }
        const int id = boards_[static_cast<std::size_t>(sighting.board)].id;
        PlacementOf(m, id).seen.push_back(std::move(observation));
      }
    }
  }

  // The LiDAR's boards are those of the camera with the most matches; others add what it lacks.
  void AddLidar(std::size_t lidar) {
    std::vector<std::pair<std::size_t, std::vector<BoardView>>> by_camera;
    for (std::size_t s = 0; s < session_.sensors.size(); ++s) {
      if (!IsCamera(s)) continue;
      by_camera.emplace_back(s, MatchWith(s, lidar));
    }
    std::ranges::stable_sort(
        by_camera, [](const auto& a, const auto& b) { return a.second.size() > b.second.size(); });
    std::map<std::pair<std::size_t, int>, bool> known;
    for (auto& [camera, views] : by_camera) {
      for (BoardView& view : views) {
        const auto moment = static_cast<std::size_t>(view.view);
        if (!known.emplace(std::pair(moment, view.board), true).second) continue;
        AddReturns(lidar, moment, std::move(view));
      }
    }
  }

  void AddReturns(std::size_t lidar, std::size_t moment, BoardView view) {
    RigObservation observation{.sensor = lidar, .sensor_from_board = view.lidar_from_board};
    observation.raw.face_in_lidar = std::move(view.face_in_lidar);
    observation.raw.face_rings = std::move(view.face_rings);
    observation.raw.range_sigma_m = view.range_sigma_m;
    observation.raw.edges = std::move(view.edges);
    PlacementOf(moment, view.board).seen.push_back(std::move(observation));
  }

  // The poses of the boards that a LiDAR is known to see at a moment.
  std::vector<Rigid3d> KnownPoses(std::size_t lidar, std::size_t moment) const {
    std::vector<Rigid3d> poses;
    for (const auto& [key, placement] : placements_) {
      if (key.first != moment) continue;
      for (const RigObservation& seen : placement.seen) {
        if (seen.sensor == lidar) poses.push_back(*seen.sensor_from_board);
      }
    }
    return poses;
  }

  bool Sees(std::size_t sensor, std::size_t moment, int board) const {
    const auto at = placements_.find({moment, board});
    if (at == placements_.end()) return false;
    return std::ranges::count(at->second.seen, sensor, &RigObservation::sensor) > 0;
  }

  // Moments in which no camera identifies what a LiDAR sees: another LiDAR does.
  void AddByLidar(std::size_t lidar, std::size_t other) {
    std::vector<Observation> views(session_.moments.size());
    std::vector<ScanAsImage> images(views.size());
    int shared = 0;
    for (std::size_t m = 0; m < views.size(); ++m) {
      const Observation* scan = SeenBy(lidar, m);
      const Observation* reference = SeenBy(other, m);
      if (scan == nullptr || reference == nullptr || !KnownPoses(lidar, m).empty()) continue;
      images[m] = AsImage(*reference, KnownPoses(other, m));
      views[m].in_image = images[m].image.in_image;
      views[m].in_scan = scan->in_scan;
      shared += views[m].in_image.empty() || views[m].in_scan.empty() ? 0 : 1;
    }
    MatchSettings settings = options_.match;
    if (!settings.initial) settings.initial = Rigid3d{};  // Upright, and facing the same way.
    const Expected<Matching> matching = MatchViews(views, settings);
    constexpr int kMinBoards = 3;
    if (!matching || std::ssize(matching->kept) < std::max(kMinBoards, (shared + 1) / 2)) return;
    for (const MatchedBoard& match : matching->kept) {
      const auto m = static_cast<std::size_t>(match.view);
      BoardView view = MakeBoardView(views[m], match, boards_);
      if (!Sees(other, m, view.board)) {
        AddReturns(other, m, ViewOfSighting(*SeenBy(other, m), images[m], match.sighting, boards_));
      }
      if (!Sees(lidar, m, view.board)) AddReturns(lidar, m, std::move(view));
    }
  }

  std::vector<BoardView> MatchWith(std::size_t camera, std::size_t lidar) {
    std::vector<SessionView> views(session_.moments.size());
    for (std::size_t m = 0; m < views.size(); ++m) {
      views[m].name = session_.moments[m].name;
      views[m].seen = Observation{};
      const Observation* image = SeenBy(camera, m);
      const Observation* scan = SeenBy(lidar, m);
      if (image == nullptr || scan == nullptr) continue;
      views[m].seen->in_image = image->in_image;
      views[m].seen->in_scan = scan->in_scan;
      views[m].seen->missing = image->missing;
      views[m].seen->missing.insert(views[m].seen->missing.end(), scan->missing.begin(),
                                    scan->missing.end());
      views[m].seen->lidar = scan->lidar;
    }
    const Expected<Assembly> assembly =
        Assemble(views, boards_, *result_.rig.problem.sensors[camera].camera, options_.match);
    if (assembly) return assembly->problem.board_views;
    result_.notes.push_back(fmt::format("{} with {}: {}", session_.sensors[camera].name,
                                        session_.sensors[lidar].name, assembly.error().message));
    return {};
  }

  const RigSession& session_;
  const ObserveRigOptions& options_;
  std::vector<Board> boards_;
  std::vector<Observer> observers_;
  std::vector<Observations> seen_;  ///< By sensor.
  std::map<std::pair<std::size_t, int>, RigPlacement> placements_;
  ObservedRig result_;
};

}  // namespace

Expected<ObservedRig> ObserveRig(const RigSession& session, const ObserveRigOptions& options) {
  std::vector<Board> boards = options.boards;
  if (boards.empty() && !session.boards.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(boards, ReadBoards(session.boards));
  }
  if (boards.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     "the boards are missing: the session does not name a board file");
  }
  if (session.moments.empty()) {
    return MakeError(ErrorCode::kMissingData, "the session has no files of images and scans");
  }
  return RigAssembly(session, options, std::move(boards)).Run();
}

}  // namespace sextant
