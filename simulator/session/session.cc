// SPDX-License-Identifier: Apache-2.0
#include "simulator/session/session.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <vector>

#include "base/nearest_name.h"
#include "base/text/escape.h"
#include "base/version.h"
#include "io/boards/board_file.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/pcd_file.h"
#include "io/output/remove_file.h"
#include "io/problems/problem_yaml.h"
#include "io/text/yaml_text.h"
#include "simulator/camera/render.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"
#include "simulator/scene/camera_model.h"
#include "simulator/scene/truth_yaml.h"
#include "simulator/session/session_folder.h"
#include "simulator/session/validate_scene.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxScans = 100'000;

const std::array<std::string, 3>& LevelNames() {
  static const std::array<std::string, 3> names = {"full", "corners", "pairs"};
  return names;
}

const std::string& NameOf(SessionLevel level) {
  return LevelNames()[static_cast<std::size_t>(level)];
}

Expected<void> CheckOptions(const SessionOptions& options) {
  const CornerNoise& noise = options.noise;
  if (options.scans < 1 || options.scans > kMaxScans) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("expected 1 to {} scans, got {}", kMaxScans, options.scans));
  }
  if (!(options.interval_s >= 0.0) || !std::isfinite(options.interval_s)) {
    return MakeError(ErrorCode::kInvalidOption, "expected an interval of zero or more seconds");
  }
  for (const double sigma : {noise.lidar_sigma_m, noise.camera_lateral_sigma_m,
                             noise.camera_depth_sigma_m, noise.pixel_sigma_px}) {
    if (!(sigma > 0.0) || !std::isfinite(sigma)) {
      return MakeError(ErrorCode::kInvalidOption,
                       fmt::format("expected positive noise of the corners, got {}", sigma));
    }
  }
  return {};
}

// Everything besides the scene that determines the bytes of the files, except for the number of
// scans.
std::string Configuration(const SessionOptions& options) {
  YamlText out;
  out.Line("sextant_simulation: 1");
  out.Line("version: {}", YamlQuoted(std::string(Version())));
  out.Line("level: {}", NameOf(options.level));
  out.Line("seed: {}", options.seed);
  if (options.unit) out.Line("unit: {}", *options.unit);
  out.Line("interval_s: {}", options.interval_s);
  if (options.level == SessionLevel::kFull) {
    out.Line("ideal: {}", options.ideal);
    out.Line("encoding: {}", ToString(options.encoding));
  } else {
    const CornerNoise& noise = options.noise;
    out.Line("lidar_sigma_m: {}", noise.lidar_sigma_m);
    out.Line("camera_lateral_sigma_m: {}", noise.camera_lateral_sigma_m);
    out.Line("camera_depth_sigma_m: {}", noise.camera_depth_sigma_m);
    out.Line("pixel_sigma_px: {}", noise.pixel_sigma_px);
  }
  return out.Take();
}

std::string ScanName(int scan) { return fmt::format("scan_{:03}.pcd", scan); }
std::string ImageName(const std::string& camera, int scan) {
  return fmt::format("{}_{:03}.png", camera, scan);
}

class Session {
 public:
  Session(const Scene& scene, const SessionOptions& options, LidarModel lidar, SessionFolder folder)
      : scene_(scene), options_(options), lidar_(std::move(lidar)), folder_(std::move(folder)) {}

  Expected<SessionReport> Run() {
    SEXTANT_ASSIGN_OR_RETURN(const std::vector<fs::path> stale, StaleFiles());
    SEXTANT_RETURN_IF_ERROR(WriteBoardsAndCameras());
    for (int scan = 0; scan < options_.scans; ++scan) truths_.push_back(TruthOf(scan));
    if (options_.level == SessionLevel::kFull) {
      for (const ScanTruth& truth : truths_) SEXTANT_RETURN_IF_ERROR(WriteScan(truth));
    } else {
      for (std::size_t i = 0; i < scene_.cameras.size(); ++i) {
        SEXTANT_RETURN_IF_ERROR(WriteProblem(i));
      }
    }
    SEXTANT_RETURN_IF_ERROR(
        folder_.Write("truth.yaml", FormatTruth(scene_, options_.seed, truths_)));
    // Only now: truth.yaml never names a file that is gone.
    for (const fs::path& file : stale) SEXTANT_RETURN_IF_ERROR(RemoveFile(file));
    report_.removed = static_cast<int>(stale.size());
    report_.lock = folder_.lock();
    report_.scans = std::move(truths_);
    return std::move(report_);
  }

 private:
  std::uint64_t SeedOf(std::size_t camera, int scan) const {
    return DeriveSeed(options_.seed, "session: " + NameOf(options_.level), camera,
                      static_cast<std::uint64_t>(scan));
  }

  ScanTruth TruthOf(int scan) const {
    ScanTruth truth;
    truth.index = scan;
    truth.start_time_s = scan * options_.interval_s;
    truth.image_time_s = truth.start_time_s + 0.5 * lidar_.turn_period_s;
    for (std::size_t i = 0; i < scene_.cameras.size(); ++i) {
      truth.image_seeds.push_back(SeedOf(i, scan));
    }
    if (options_.level == SessionLevel::kFull) {
      truth.scan_file = ScanName(scan);
      for (const SceneCamera& camera : scene_.cameras) {
        truth.image_files.push_back(ImageName(camera.name, scan));
      }
    }
    truth.boards = BoardsAt(scene_, truth.image_time_s);
    return truth;
  }

  // Files of an earlier run that had more scans, and a recording of another number of scans.
  Expected<std::vector<fs::path>> StaleFiles() const {
    std::vector<fs::path> stale;
    if (options_.level != SessionLevel::kFull) return stale;
    SEXTANT_ASSIGN_OR_RETURN(const std::vector<std::string> names, folder_.FileNames());
    const std::set<std::string> there(names.begin(), names.end());
    for (const std::string& name : names) {
      if (IsOfLaterScan(name)) stale.push_back(folder_.path() / name);
    }
    const bool is_longer = !there.contains(ScanName(options_.scans - 1));
    if ((is_longer || !stale.empty()) && there.contains(kSessionBag)) {
      stale.push_back(folder_.path() / kSessionBag);
    }
    for (const fs::path& file : stale) SEXTANT_RETURN_IF_ERROR(CheckRemovable(file));
    return stale;
  }

  bool IsOfLaterScan(const std::string& name) const {
    const std::size_t digits = name.find_last_of('_') + 1;
    int scan = 0;
    std::from_chars(name.data() + digits, name.data() + name.size(), scan);
    if (digits == 0 || scan < options_.scans) return false;
    return name == ScanName(scan) || std::ranges::any_of(scene_.cameras, [&](const auto& camera) {
             return name == ImageName(camera.name, scan);
           });
  }

  Expected<void> WriteBoardsAndCameras() {
    SEXTANT_RETURN_IF_ERROR(folder_.Write("boards.yaml", FormatBoards(BoardsIn(scene_))));
    for (const SceneCamera& camera : scene_.cameras) {
      const std::string text = FormatCameraInfo(*PublishedCamera(camera), camera.name);
      SEXTANT_RETURN_IF_ERROR(folder_.Write(camera.name + "_info.yaml", text));
    }
    return {};
  }

  Expected<void> Complete(const std::string& name,
                          const std::function<Expected<std::string>()>& make) {
    SEXTANT_ASSIGN_OR_RETURN(const bool written, folder_.Complete(name, make));
    written ? ++report_.written : ++report_.kept;
    if (options_.step) options_.step();
    return {};
  }

  Expected<void> WriteScan(const ScanTruth& truth) {
    SEXTANT_RETURN_IF_ERROR(Complete(truth.scan_file, [&] { return ScanFile(truth); }));
    for (std::size_t i = 0; i < scene_.cameras.size(); ++i) {
      SEXTANT_RETURN_IF_ERROR(Complete(truth.image_files[i], [&] { return ImageFile(truth, i); }));
    }
    return {};
  }

  Expected<std::string> ScanFile(const ScanTruth& truth) const {
    const bool real = !options_.ideal;
    SEXTANT_ASSIGN_OR_RETURN(const SimulatedScan scan,
                             SimulateScan(scene_, lidar_,
                                          {.seed = options_.seed,
                                           .unit = options_.unit,
                                           .scan_index = truth.index,
                                           .start_time_s = truth.start_time_s,
                                           .noise = real,
                                           .quantisation = real,
                                           .divergence = real,
                                           .dropouts = real}));
    return FormatPcd(scan.cloud, options_.encoding);
  }

  Expected<std::string> ImageFile(const ScanTruth& truth, std::size_t camera) const {
    ImageOptions ideal;
    ideal.time_s = truth.image_time_s;
    const ImageOptions image_options =
        options_.ideal ? ideal : UsualImageOptions(truth.image_seeds[camera], truth.image_time_s);
    SEXTANT_ASSIGN_OR_RETURN(const cv::Mat image,
                             RenderImage(scene_, static_cast<int>(camera), image_options));
    return options_.encode_image(image);
  }

  // This file changes with the number of scans, so it is always rewritten.
  Expected<void> WriteProblem(std::size_t camera) {
    const SceneCamera& scene_camera = scene_.cameras[camera];
    ProblemFile file;
    file.problem.camera = *PublishedCamera(scene_camera);
    file.problem.boards = BoardsIn(scene_);
    file.true_cam_from_lidar = CamFromLidar(scene_, scene_camera);
    file.comment = fmt::format("simulated: scene {}, seed {}, {} scans", scene_.name, options_.seed,
                               options_.scans);
    for (const ScanTruth& truth : truths_) AddView(truth, camera, file.problem);
    if (options_.level == SessionLevel::kPairs) file.problem.pairs_3d3d.clear();
    file.problem.point_sets = WithholdPairing(file.problem.pairs_3d3d);
    const std::string name = fmt::format("{}_{}.yaml", NameOf(options_.level), scene_camera.name);
    Expected<void> ok = folder_.Write(name, FormatProblemYaml(file));
    ++report_.written;
    if (options_.step) options_.step();
    return ok;
  }

  void AddView(const ScanTruth& truth, std::size_t camera, CalibrationProblem& problem) const {
    Random random(truth.image_seeds[camera]);
    for (const BoardTruth& board : truth.boards) {
      for (std::size_t i = 0; i < board.corners.size(); ++i) {
        const CornerTruth& corner = board.corners[i];
        if (!corner.pixel[camera]) continue;
        AddMeasuredCorner(options_.noise, {truth.index, board.id, static_cast<int>(i)},
                          corner.in_cam[camera], corner.in_lidar, *corner.pixel[camera], random,
                          problem);
      }
    }
  }

  const Scene& scene_;
  const SessionOptions& options_;
  LidarModel lidar_;
  SessionFolder folder_;
  std::vector<ScanTruth> truths_;
  SessionReport report_;
};

}  // namespace

Expected<SessionLevel> FindSessionLevel(std::string_view name) {
  const auto found = std::find(LevelNames().begin(), LevelNames().end(), name);
  if (found != LevelNames().end()) {
    return static_cast<SessionLevel>(found - LevelNames().begin());
  }
  return MakeError(ErrorCode::kUnknownName,
                   fmt::format("no level '{}'; {}", name, SuggestName(name, LevelNames())));
}

long CountSessionFiles(const Scene& scene, const SessionOptions& options) {
  const auto cameras = static_cast<long>(scene.cameras.size());
  return options.level == SessionLevel::kFull ? options.scans * (1 + cameras) : cameras;
}

Expected<SessionReport> SimulateSession(const Scene& scene, std::string_view scene_text,
                                        const SessionOptions& options) {
  SEXTANT_RETURN_IF_ERROR(CheckOptions(options));
  SEXTANT_RETURN_IF_ERROR(ValidateScene(scene));
  SEXTANT_ASSIGN_OR_RETURN(LidarModel lidar, FindLidarModel(scene.lidar.model));
  SEXTANT_ASSIGN_OR_RETURN(SessionFolder folder,
                           SessionFolder::Open(options.folder, scene_text, Configuration(options)));
  return Session(scene, options, std::move(lidar), std::move(folder)).Run();
}

}  // namespace sextant
